#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// No link delays a reading longer, and no two synchronised clocks differ by more.
constexpr double kLongestDelay_s = 1.0;

/// Readings of one sensor that wait for the first stereo pair that is not before them. Only the pairs' stamps define
/// the time: a reading without a stamp, or farther from the pairs than kLongestDelay_s, is refused here, before it is
/// used. Readings that wait when the first pair comes, or when the pairs' clock is set back, are of another time, and
/// are dropped silently. One thread.
template <typename Reading>
class PendingReadings {
 public:
  /// @param stamp_s NaN: the reading has none.
  void put(double stamp_s, Reading reading) {
    if (waiting_.size() == kMostWaiting) {
      waiting_.erase(waiting_.begin(), waiting_.begin() + kMostWaiting / 2);
      lost_ += kMostWaiting / 2;
    }
    waiting_.push_back({stamp_s, std::move(reading)});
  }

  /// Takes those not after a pair, in the order of arrival; later ones keep waiting.
  /// @return valid until the next call.
  const std::vector<Reading>& take(double pair_stamp_s) {
    const bool begins = !(pair_stamp_s >= pair_stamp_s_ - kLongestDelay_s);
    const double earliest_s = (begins ? pair_stamp_s : pair_stamp_s_) - kLongestDelay_s;
    taken_.clear();
    auto later = waiting_.begin();
    for (const Waiting& waiting : waiting_) {
      const bool is_plausible = earliest_s <= waiting.stamp_s && waiting.stamp_s <= pair_stamp_s + kLongestDelay_s;
      if (is_plausible && waiting.stamp_s <= pair_stamp_s) {
        taken_.push_back(waiting.reading);
      } else if (is_plausible) {
        *later++ = waiting;
      } else if (!begins) {
        ++refused_;
        difference_s_ = waiting.stamp_s - pair_stamp_s;
      }
    }
    waiting_.erase(later, waiting_.end());
    pair_stamp_s_ = pair_stamp_s;
    return taken_;
  }

  /// Drops the waiting readings, and the knowledge of the time.
  void forget() {
    waiting_.clear();
    pair_stamp_s_ = kNaN;
  }

  /// Number refused for their stamps, or dropped for newer ones because no pair came.
  std::uint64_t refused() const { return refused_ + lost_; }
  /// The last one's stamp less the pair's [s]; NaN: without a stamp.
  double refusedDifference() const { return difference_s_; }

 private:
  // While no pair comes: 16 s at 1 kHz, then the older half is dropped.
  static constexpr std::size_t kMostWaiting = 1 << 14;

  struct Waiting {
    double stamp_s;
    Reading reading;
  };

  std::vector<Waiting> waiting_;
  std::vector<Reading> taken_;  // scratch
  double pair_stamp_s_ = kNaN;  // of the newest pair
  std::uint64_t refused_ = 0, lost_ = 0;
  double difference_s_ = kNaN;
};

}  // namespace flight_corridor
