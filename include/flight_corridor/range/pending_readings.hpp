#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// No link holds a reading back longer, and no two clocks that are set alike differ by more.
constexpr double kLongestDelay_s = 1.0;

/// Readings of one sensor that wait for the stereo pair that is not before them. The pairs' stamps alone say what time
/// it is: a reading without a stamp, or farther from the pairs than kLongestDelay_s, is refused here, before anybody
/// believes it. What waits when the first pair comes, or when the pairs' clock is set back, is of another time, and
/// goes without a word. One thread.
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

  /// Those not after a pair, in the order of arrival; later ones go on waiting for theirs.
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

  /// What waits goes, and so does what is known of the time.
  void forget() {
    waiting_.clear();
    pair_stamp_s_ = kNaN;
  }

  /// How many were refused for their stamp, or gave way to newer ones because no pair came.
  std::uint64_t refused() const { return refused_ + lost_; }
  /// The last one's stamp less the pair's [s]; NaN: it had none.
  double refusedDifference() const { return difference_s_; }

 private:
  // While no pair comes: 16 s at 1 kHz, then the older half goes.
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
