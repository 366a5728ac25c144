#include "flight_corridor/range/lidar_watch.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr int kTooManyRepetitions = 3;    // noise hardly allows that
constexpr double kRateMemory_s = 0.3;     // of the rate's exponential mean: longer than links hold readings back
constexpr double kBestMemory_s = 10.0;    // of the best rate: drivers flush buffers when they start
constexpr double kSlowShare = 1.0 / 3.0;  // of the best rate

}  // namespace

void LidarWatch::add(const RangeReading& reading, bool fused) {
  if (!std::isfinite(reading.stamp_s)) return;
  if (reading.stamp_s < newest_.stamp_s) return;
  const double since_s = std::isnan(newest_.stamp_s) ? 0.0 : reading.stamp_s - newest_.stamp_s;
  rate_hz_ = rate(reading.stamp_s) + 1.0 / kRateMemory_s;
  best_rate_hz_ = std::max(best_rate_hz_ * std::exp(-since_s / kBestMemory_s), rate_hz_);
  repetitions_ = reading.range_m == newest_.range_m ? repetitions_ + 1 : 0;
  if (reading.range_m == -kInfinity) too_close_s_ = reading.stamp_s;
  if (fused) {
    too_close_s_ = kNaN;
    valid_ = reading;
  } else if (!(reading.range_m > valid_.range_m)) {
    valid_ = RangeReading();
  }
  newest_ = reading;
  fused_ = fused;
}

/// Exponential mean of the impulses that readings are.
double LidarWatch::rate(double stamp_s) const {
  const double since_s = stamp_s - newest_.stamp_s;
  return since_s >= 0.0 ? rate_hz_ * std::exp(-since_s / kRateMemory_s) : rate_hz_;
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

bool LidarWatch::repeatsItself() const { return repetitions_ >= kTooManyRepetitions; }

bool LidarWatch::isSlow(double stamp_s) const { return rate(stamp_s) < kSlowShare * best_rate_hz_; }

}  // namespace flight_corridor
