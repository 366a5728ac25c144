#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace flight_corridor::sim {

/// A smooth shift of a flight's line, along y and z of W.
struct Sidestep {
  double from_s = 0.0;
  double duration_s = 1.0;
  double left_m = 0.0;
  double up_m = 0.0;
};

/// A smooth change of heading; its yaw rate rises to twice its mean. The flight follows its heading.
struct Turn {
  double from_s = 0.0;
  double duration_s = 1.0;
  double left_rad = 0.0;
};

/// A flight, at first along +x of W, that speeds up and brakes smoothly, while the body sways and wobbles.
/// W: z up. B: x forward, y left, z up.
struct Flight {
  Eigen::Vector3d start_W{0.0, 0.0, 1.5};
  double speed_m_s = 1.0;  ///< Between the ramps.
  double ramp_s = 0.8;     ///< From standstill to speed, and back.
  double duration_s = 7.0;
  Eigen::Vector3d wobble_rad{0.03, 0.02, 0.02};  ///< Largest roll, pitch and yaw.
  Eigen::Vector3d sway_m{0.02, 0.03, 0.02};      ///< Largest shift forward, left and up.
  double phase_rad = 0.0;                        ///< Of sway and wobble.
  std::vector<Sidestep> sidesteps;
  std::vector<Turn> turns;      ///< One after the other.
  std::vector<Turn> body_yaws;  ///< Of the body alone: the flight does not follow them.
  bool tilts = false;           ///< As a quadrotor must: z of B along the thrust, before wobble comes on top.

  /// Before the start and after the end the body stands still.
  Eigen::Isometry3d T_W_B(double time_s) const;
};

/// Duration of a flight over a distance.
double durationOver(double distance_m, double speed_m_s, double ramp_s);

/// A turn on the way so fast that its yaw rate rises to a limit.
Turn turnAt(double from_s, double left_rad, double highest_rate_rad_s);

/// Turns to the left, to the right and so on by an angle from straight ahead, with which the last one ends at until_s.
/// As many as there is time for since from_s: none, if not even for one to the left and back.
std::vector<Turn> yawSweep(double from_s, double until_s, double angle_rad, double highest_rate_rad_s);

}  // namespace flight_corridor::sim
