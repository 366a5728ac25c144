#pragma once

#include <Eigen/Geometry>
#include <deque>

namespace flight_corridor::sim {

/// Limits of a quadrotor under velocity control. Defaults as in SpeedConfig.
struct QuadrotorLimits {
  double acceleration_mps2 = 3.0;
  double jerk_mps3 = 8.0;
  double yaw_rate_rad_s = 1.05;  ///< 60 degrees/s.
  double yaw_acceleration_rad_s2 = 4.0;
  double latency_s = 0.1;  ///< From a command until it takes effect.
};

/// A command to the autopilot.
struct VelocityCommand {
  Eigen::Vector3d velocity_W_mps = Eigen::Vector3d::Zero();
  double yaw_rate_rad_s = 0.0;  ///< To the left.
};

/// A quadrotor without wind and drag: its thrust, along z of B, accelerates it. So it tilts, and the camera with it. W:
/// z up. B: x forward, y left, z up.
class Quadrotor {
 public:
  Quadrotor(const QuadrotorLimits& limits, const Eigen::Vector3d& p_W, double heading_rad);

  /// Followed from the limits' latency on.
  void command(const VelocityCommand& command) { commands_.push_back({time_s_ + limits_.latency_s, command}); }
  /// Lets time pass, up to a moment.
  void flyUntil(double time_s);

  double time_s() const { return time_s_; }  ///< Since the start.
  Eigen::Isometry3d T_W_B() const;
  const Eigen::Vector3d& velocity_W_mps() const { return velocity_W_; }
  const Eigen::Vector3d& acceleration_W_mps2() const { return acceleration_W_; }
  double yawRate() const { return yaw_rate_rad_s_; }  ///< [rad/s]

 private:
  struct Timed {
    double from_s;
    VelocityCommand command;
  };

  void step(double step_s);

  QuadrotorLimits limits_;
  double time_s_ = 0.0;
  std::deque<Timed> commands_;  // the first is being followed, the others wait
  Eigen::Vector3d p_W_, velocity_W_ = Eigen::Vector3d::Zero(), acceleration_W_ = Eigen::Vector3d::Zero();
  double heading_rad_, yaw_rate_rad_s_ = 0.0;
};

}  // namespace flight_corridor::sim
