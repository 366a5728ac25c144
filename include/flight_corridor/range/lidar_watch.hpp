#pragma once

#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Memory of a LiDAR: its newest reading, the last one that was believed, and the rate of readings.
class LidarWatch {
 public:
  /// Adds a reading, in any order; one older than the newest changes nothing.
  /// @param fused whether it was believed.
  void add(const RangeReading& reading, bool fused);

  /// The newest reading [m], if it was believed and its stamp is within max_age_s of this one; else NaN.
  double range(double stamp_s, double max_age_s) const;
  /// Whether a reading, at most this old, was believed, and all later ones were of farther surfaces: the beam now
  /// passes that surface.
  bool hasValidRange(double stamp_s, double max_age_s) const;
  /// Whether a reading, at most this old, reported an obstacle too close to be measured, -inf (REP-117), and none was
  /// believed since.
  bool isTooClose(double stamp_s, double max_age_s) const;
  /// Whether no reading was believed for this long.
  bool isSilent(double stamp_s, double max_age_s) const { return !(stamp_s - believed_s_ <= max_age_s); }
  bool isRejected() const { return newest_.stamp_s == newest_.stamp_s && !fused_; }
  /// Whether the newest pause between readings, up to this stamp, is longer than a link's and than three times the
  /// recent mean.
  bool isSlow(double stamp_s) const;
  /// Full width of the beam's cone [rad]; 0 before the first reading.
  double beamWidth() const { return newest_.field_of_view_rad; }

 private:
  RangeReading newest_;  // its stamp is NaN before the first one
  bool fused_ = false;
  double believed_s_ = kNaN;    // the last such reading
  RangeReading valid_;          // the last one that was believed, unless a nearer one was not since
  double too_close_s_ = kNaN;   // of the last such reading, unless one was believed since
  double pause_s_ = kNaN;       // before the newest reading
  double mean_pause_s_ = kNaN;  // recent
};

}  // namespace flight_corridor
