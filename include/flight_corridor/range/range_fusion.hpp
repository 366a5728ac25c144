#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Section `fusion/` of doc/parameters.md: noise, gate and memory of the range's Kalman filter.
struct FusionConfig {
  double acceleration_sigma_mps2 = 3.0;
  double lidar_variance_m2 = 0.0005798584;
  double stereo_variance_m2 = 0.0;
  double disparity_sigma_px = 0.1;
  double gate_sigma = 4.0;
  double lasting_s = 0.2;
  double max_gap_s = 0.5;
  double buffer_s = 0.5;
};
/// Every broken rule.
Violations check(const FusionConfig& config);

enum class Sensor : std::uint8_t { Lidar = 0, Stereo = 1 };

/// The outcome of a reading.
enum class Outcome : std::uint8_t { Accepted, Gated, Reinitialised, TooLate, Invalid };

/// A sensor that is persistently outside the other's gate.
struct Disagreement {
  Sensor sensor;   ///< Stereo if both are: the range follows a nearer LiDAR.
  double range_m;  ///< Its own range.
};

/// d_K and its uncertainty.
struct RangeEstimate {
  double range_m =
      kNaN;  ///< d_K along the beam, not negative; NaN unless two readings agreed and one came within fusion/max_gap_s.
  double sigma_m = kNaN;                     ///< One sigma of range_m.
  double rate_mps = kNaN;                    ///< Of range_m; negative while the surface comes nearer.
  std::optional<Disagreement> disagreement;  ///< None while the sensors agree.
  bool lidar_repeats = false;                ///< The LiDAR's readings are equal too often for noise: it may be frozen.
};

/// Kalman filter of the range on the beam: state [range, range rate], input acceleration, readings of both sensors at
/// their own stamps (Trejo et al. 2019, eqs. 3-9, with the white-acceleration process noise of Bar-Shalom 2001, eq.
/// 6.2.2-12). A reading that the surface followed does not explain supports or begins a challenger, which may replace
/// it. Late readings are inserted by replay: any arrival order within the buffer gives the same state. No allocation
/// after construction.
class RangeFusion {
 public:
  /// @throws std::invalid_argument with every broken rule.
  explicit RangeFusion(const FusionConfig& config);

  /// @param range_m along the beam, > 0.  @param variance_m2 measurement noise R, > 0.
  /// @param common_sigma_1pm one sigma of an error of the inverse range that is the same in all of the sensor's
  /// readings [1/m]: it counts between the sensors, not among these readings.
  /// @return the outcome; Invalid for a reading that is not finite or not positive (not an error).
  Outcome add(Sensor sensor, double stamp_s, double range_m, double variance_m2, double common_sigma_1pm = 0.0);

  /// Input u: the rig's own acceleration along the beam, gravity removed [m/s^2]; holds until the next one, at most 0.1
  /// s.  @return Invalid for one that is not finite, or that no rig has (not an error).
  Outcome addAcceleration(double stamp_s, double acceleration_mps2);

  /// The estimate predicted to a stamp not before the buffer's start.
  RangeEstimate at(double stamp_s) const;

 private:
  enum class Kind : std::uint8_t { Acceleration, Lidar, Stereo };  // in the order of processing at equal stamps
  struct Reading {
    Kind kind = Kind::Lidar;
    double stamp_s = kNaN, value = kNaN, variance_m2 = kNaN;  // value: range [m] or acceleration [m/s^2]
    double common_sigma_1pm = 0.0;
  };
  struct Surface {  // a hypothesis: the Kalman filter of the readings that fit it
    double stamp_s = kNaN;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    double common_sigma_1pm = 0.0;  // of the readings that support the range
    double begun_s = kNaN;
    std::array<int, 2> readings{};  // of each sensor; when it saw the surface last, and how long after the time before
    std::array<double, 2> seen_s{-kInfinity, -kInfinity}, period_s{kInfinity, kInfinity};
    int count() const { return readings[0] + readings[1]; }
    bool isConfirmed() const { return count() > 1; }  // a lone reading may be a spike
    double lastSeen() const { return std::max(seen_s[0], seen_s[1]); }
  };
  struct Repetition {       // a LiDAR whose readings are bit-identical
    Reading lidar, stereo;  // each sensor's first
    int readings = 0;
    double speed_mps = 0.0;  // of the range when it began, less one sigma
    bool overdue = false;    // at that speed the LiDAR should have moved
    int moved = 0;           // consecutive stereo readings that have moved: a single one may be a peak
    bool isFrozen() const { return overdue || moved >= 2; }
  };
  struct Filter {                     // everything that one reading changes: a copy is a memory
    std::array<Surface, 3> surfaces;  // the one followed, and two challengers
    double acceleration_s = -kInfinity, acceleration_mps2 = 0.0;
    Repetition repetition;
  };
  struct Step {
    Reading reading;
    Filter after;
    Outcome outcome;
  };

  static std::size_t sensorOf(const Reading& reading) { return reading.kind == Kind::Lidar ? 0 : 1; }
  Outcome insert(const Reading& reading);
  void forgetOldest();
  Outcome update(Filter& filter, const Reading& reading) const;
  Surface predicted(const Surface& surface, const Filter& filter, double stamp_s) const;
  Outcome fuse(Filter& filter, const Reading& reading) const;
  Surface& surfaceOf(Filter& filter, const Reading& reading) const;
  double misfit(const Surface& surface, const Reading& reading) const;
  static double commonVariance(const Surface& surface, const Reading& reading);
  static void correct(Surface& surface, const Reading& reading);
  const Surface* elsewhere(const Filter& filter, std::size_t sensor, double stamp_s) const;
  bool replaces(const Surface& challenger, const Filter& filter, const Reading& reading) const;
  bool watchRepetition(Repetition& repetition, const Surface& followed, const Reading& reading) const;
  bool differ(const Reading& a, const Reading& b) const;

  FusionConfig config_;
  Step before_;              // the newest that was forgotten
  std::vector<Step> steps_;  // ordered by stamp
};

}  // namespace flight_corridor
