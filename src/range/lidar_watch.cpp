#include "flight_corridor/range/lidar_watch.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr double kMemory_s = 10.0;       // of the mean pause
constexpr double kLongestLink_s = 0.15;  // links hold readings back no longer, and stamp them when they come
constexpr double kSlow = 3.0;            // mean pauses

}  // namespace

void LidarWatch::add(const RangeReading& reading, bool fused) {
  if (!std::isfinite(reading.stamp_s)) return;
  if (reading.stamp_s < newest_.stamp_s) return;
  pause_s_ = reading.stamp_s - newest_.stamp_s;
  const double counted_s = std::min(pause_s_, 1.0);
  if (std::isnan(mean_pause_s_)) mean_pause_s_ = counted_s;
  if (pause_s_ > 0.0) mean_pause_s_ += (1.0 - std::exp(-counted_s / kMemory_s)) * (counted_s - mean_pause_s_);
  if (reading.range_m == -kInfinity) too_close_s_ = reading.stamp_s;
  if (fused) {
    too_close_s_ = kNaN;
    believed_s_ = reading.stamp_s;
    valid_ = reading;
  } else if (!(reading.range_m > valid_.range_m)) {
    valid_ = RangeReading();
  }
  newest_ = reading;
  fused_ = fused;
}

double LidarWatch::range(double stamp_s, double max_age_s) const {
  return fused_ && std::abs(stamp_s - newest_.stamp_s) <= max_age_s ? newest_.range_m : kNaN;
}

bool LidarWatch::hasValidRange(double stamp_s, double max_age_s) const {
  return std::abs(stamp_s - valid_.stamp_s) <= max_age_s;
}

bool LidarWatch::isTooClose(double stamp_s, double max_age_s) const {
  return std::abs(stamp_s - too_close_s_) <= max_age_s;
}

/// The mean is one over time: of a burst it is the pause before it.
bool LidarWatch::isSlow(double stamp_s) const {
  return std::max(pause_s_, stamp_s - newest_.stamp_s) > std::max(kLongestLink_s, kSlow * mean_pause_s_);
}

}  // namespace flight_corridor
