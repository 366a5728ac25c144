#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <deque>

#include "flight_corridor/types.hpp"

namespace flight_corridor {

struct FusionConfig {
  double acceleration_sigma_mps2 = 3.0;     ///< White acceleration noise, per sqrt(Hz); 0 only to reproduce the paper.
  double lidar_variance_m2 = 0.0005798584;  ///< R of the LiDAR.
  double stereo_variance_m2 = 0.0;          ///< Constant part of R of the stereo range.
  double disparity_sigma_px = 0.3;          ///< sigma_d of R_stereo = (Z^2/(fB) sigma_d)^2 + stereo_variance_m2.
  double gate_sigma = 4.0;                  ///< Readings further from the prediction are gated; inf switches it off.
  double lasting_s = 0.2;                   ///< A sensor gated for so long is in lasting disagreement.
  double max_gap_s = 0.5;                   ///< Without readings for so long the state is forgotten.
  double buffer_s = 0.5;                    ///< Readings up to so late are put where they belong.
};
Violations check(const FusionConfig& config);

enum class Sensor : std::uint8_t { Lidar = 0, Stereo = 1 };

/// What became of a reading.
enum class Outcome : std::uint8_t { Accepted, Gated, Reinitialised, TooLate, Invalid };

/// d_K and what is known about it.
struct RangeEstimate {
  double range_m = kNaN;  ///< d_K along the beam; NaN unless two readings agreed and one came within fusion/max_gap_s.
  double sigma_m = kNaN;
  double rate_mps = kNaN;
  bool disagreement = false;    ///< One sensor is lastingly outside the other's gate.
  double disagreeing_m = kNaN;  ///< What that sensor says.
};

/// Kalman filter of the range on the beam: state [range, range rate], readings of both sensors at their own stamps
/// (Trejo et al. 2019, eqs. 3-9, with the white-acceleration process noise of Bar-Shalom 2001, eq. 6.2.2-12).
/// Late readings are replayed into their place: any arrival order within the buffer gives the same state.
class RangeFusion {
 public:
  /// @throws std::invalid_argument with every broken rule.
  explicit RangeFusion(const FusionConfig& config);

  /// @param variance_m2 measurement noise R, > 0.
  Outcome add(Sensor sensor, double stamp_s, double range_m, double variance_m2);

  /// The estimate predicted to a stamp not before the buffer's start.
  RangeEstimate at(double stamp_s) const;

  void reset();

 private:
  struct Reading {
    Sensor sensor;
    double stamp_s, range_m, variance_m2;
  };
  struct SensorTrack {  // per-sensor memory that the gate needs
    double accepted_s = -kInfinity;
    double gated_since_s = kNaN;
    double gated_s = kNaN, gated_m = kNaN, gated_variance_m2 = kNaN;
  };
  struct Filter {  // everything that one reading changes: copying it is remembering it
    double stamp_s = kNaN;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    std::array<SensorTrack, 2> tracks;
    bool confirmed = false;  // by a second reading: a lone one may be a spike
    bool initialised() const { return stamp_s == stamp_s; }
    double lastAccepted() const { return std::max(tracks[0].accepted_s, tracks[1].accepted_s); }
  };
  struct Step {
    Reading reading;
    Filter after;
    Outcome outcome;
  };

  Filter predicted(const Filter& filter, double stamp_s) const;
  Outcome update(Filter& filter, const Reading& reading) const;
  void remember(SensorTrack& track, const Reading& reading) const;
  bool isNewSurface(const Filter& filter, const Reading& reading) const;
  bool agree(double a_m, double a_variance_m2, double b_m, double b_variance_m2, double apart_s) const;
  static void initialise(Filter& filter, double stamp_s, double range_m, double variance_m2);

  FusionConfig config_;
  Filter before_;           // state before the oldest buffered reading
  std::deque<Step> steps_;  // ordered by stamp
};

}  // namespace flight_corridor
