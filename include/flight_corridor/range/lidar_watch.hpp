#pragma once

#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// What is remembered of a LiDAR: its newest reading, whether it repeats itself, and how fast its readings come.
class LidarWatch {
 public:
  /// A reading, in whatever order; what is older than the newest changes nothing.
  /// @param fused whether it was believed.
  void add(const RangeReading& reading, bool fused);

  /// The newest reading [m], where it was believed and its stamp is within max_age_s of this one; else NaN.
  double range(double stamp_s, double max_age_s) const;
  /// Whether a reading, at most so old, was believed, and all since then were of farther surfaces: the beam passes what
  /// it met.
  bool hasValidRange(double stamp_s, double max_age_s) const;
  /// Whether a reading, at most so old, said that something is too close to be measured, -inf (REP-117), and none was
  /// believed since.
  bool isTooClose(double stamp_s, double max_age_s) const;
  bool isRejected() const { return newest_.stamp_s == newest_.stamp_s && !fused_; }
  /// Equal to the last bit too often to be noise.
  bool repeatsItself() const;
  /// At this stamp readings come at less than a third of their best rate of late. Bursts and a late link are no cause.
  /// For LiDARs of 3 Hz and more.
  bool isSlow(double stamp_s) const;
  /// Full width of the beam's cone [rad]; 0 before the first reading.
  double beamWidth() const { return newest_.field_of_view_rad; }

 private:
  double rate(double stamp_s) const;

  RangeReading newest_;  // its stamp is NaN before the first one
  bool fused_ = false;
  RangeReading valid_;                         // the last one that was believed, unless a nearer one was not since
  double too_close_s_ = kNaN;                  // of the last reading that said so, unless one was believed since
  int repetitions_ = 0;                        // of its range, by the readings before it
  double rate_hz_ = 0.0, best_rate_hz_ = 0.0;  // at the newest reading, and the best of late
};

}  // namespace flight_corridor
