#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "flight_corridor/corridor/safe_speed.hpp"
#include "sim/quadrotor.hpp"

namespace flight_corridor::sim {

/// A rule's result for a stereo pair.
struct Way {
  std::optional<Eigen::Vector3d> direction_W;  ///< Unit vector of the best free way; absent: no way is free.
  double free_m = 0.0;                         ///< Along it.
  double free_ahead_m = 0.0;                   ///< Along the velocity.
};

/// The UAV's own state when it decides.
struct OwnState {
  Eigen::Isometry3d T_W_B = Eigen::Isometry3d::Identity();
  Eigen::Vector3d velocity_W_mps = Eigen::Vector3d::Zero();
};

/// Flies along the best free way at its safe speed, brakes if it moves towards space that is not known to be free, and
/// turns on the spot while there is no way: first towards the goal's side, then on in that sense.
class Policy {
 public:
  /// @param age_s largest age of a way when it is used.
  Policy(const SpeedConfig& speed, double age_s) : speed_(speed), age_s_(age_s) {}

  VelocityCommand decide(const OwnState& own, const Way& way, const Eigen::Vector3d& goal_W);

 private:
  SpeedConfig speed_;
  double age_s_;
  std::optional<double> turns_left_;  ///< While it turns on the spot: +1 or -1.
};

/// From the body's heading to a direction, left positive, within [-pi, pi].
double yawTo(const Eigen::Isometry3d& T_W_B, const Eigen::Vector3d& direction_W);

}  // namespace flight_corridor::sim
