#pragma once

#include <cmath>
#include <cstddef>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "flight_corridor/motion/camera_motion.hpp"

namespace flight_corridor {

/// The newest pairs, apart from each other in place or time, what is kept of each, and how each is seen from now. One
/// object, one thread.
template <class Kept>
class PairRing {
 public:
  explicit PairRing(std::size_t most) : most_(most) {}

  /// A pair, not older than the last; of another series it is the first.
  /// @return what is kept of it, to be filled: as the oldest pair left it when the ring is full. Null: the pair is not
  /// apart from the last one, and is not kept. Valid until the next call.
  Kept* add(double stamp_s, const CameraPose& pose) {
    views_.clear();  // they point into the pairs
    if (!pairs_.empty() && pairs_.back().pose.series != pose.series) pairs_.clear();
    if (!pairs_.empty() && !isApart(stamp_s, pose)) return nullptr;
    Pair pair;
    if (pairs_.size() == most_) {
      pair = std::move(pairs_.front());
      pairs_.pop_front();
    }
    pair.stamp_s = stamp_s;
    pair.pose = pose;
    pairs_.push_back(std::move(pair));
    return &pairs_.back().kept;
  }

  /// From now on pairs are seen from this pose; absent: nobody knows from where.
  /// @param memory_s older pairs are forgotten.
  void moveTo(double stamp_s, const std::optional<CameraPose>& pose, double memory_s) {
    views_.clear();
    while (!pairs_.empty() && !(stamp_s - pairs_.front().stamp_s <= memory_s)) pairs_.pop_front();
    if (!pose) return;
    for (auto pair = pairs_.rbegin(); pair != pairs_.rend(); ++pair) {
      if (const auto motion = motionBetween(pair->pose, *pose)) {
        views_.push_back({&pair->kept, *motion, stamp_s - pair->stamp_s});
      }
    }
  }

  void forget() {
    views_.clear();
    pairs_.clear();
  }

  /// What is kept of a pair, as seen from now.
  struct View {
    const Kept* kept;
    RelativePose motion;  ///< From it until now.
    double age_s;
  };
  /// The pairs from which the motion until now is known well enough, the newest first.
  const std::vector<View>& views() const { return views_; }

 private:
  static constexpr double kApart_m = 0.05, kApart_s = 0.1;  // between two pairs that are kept

  struct Pair {
    double stamp_s = 0.0;
    CameraPose pose;
    Kept kept;
  };

  bool isApart(double stamp_s, const CameraPose& pose) const {
    const Pair& last = pairs_.back();
    return stamp_s - last.stamp_s >= kApart_s ||
           (pose.T_M_C.translation() - last.pose.T_M_C.translation()).norm() >= kApart_m;
  }

  std::size_t most_;
  std::deque<Pair> pairs_;   // the oldest first
  std::vector<View> views_;  // of them
};

}  // namespace flight_corridor
