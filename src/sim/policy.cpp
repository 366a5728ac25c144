#include "sim/policy.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor::sim {
namespace {

constexpr double kTurnRate_rad_s = 0.8;  // on the spot
constexpr double kYawGain_1ps = 1.5;     // yaw rate for an angle that is missing
constexpr double kMoving_mps = 0.3;      // slower, it may go anywhere at once
constexpr double kBend_rad = 0.6;        // between velocity and way: from here on it stops before it turns off

}  // namespace

double yawTo(const Eigen::Isometry3d& T_W_B, const Eigen::Vector3d& direction_W) {
  const double yaw_rad =
      std::atan2(direction_W.y(), direction_W.x()) - std::atan2(T_W_B.linear()(1, 0), T_W_B.linear()(0, 0));
  return std::remainder(yaw_rad, 2.0 * M_PI);
}

VelocityCommand Policy::decide(const OwnState& own, const Way& way, const Eigen::Vector3d& goal_W) {
  if (!way.direction_W) {
    if (!turns_left_) turns_left_ = yawTo(own.T_W_B, goal_W - own.T_W_B.translation()) >= 0.0 ? 1.0 : -1.0;
    return {Eigen::Vector3d::Zero(), *turns_left_ * kTurnRate_rad_s};
  }
  turns_left_.reset();
  VelocityCommand command;
  command.yaw_rate_rad_s = kYawGain_1ps * yawTo(own.T_W_B, *way.direction_W);
  const double speed_mps = own.velocity_W_mps.norm();
  double wanted_mps = safeSpeed(way.free_m, age_s_, speed_);
  if (speed_mps > kMoving_mps) {
    if (speed_mps > safeSpeed(way.free_ahead_m, age_s_, speed_) + kMoving_mps) return command;
    const double bend_rad = std::acos(std::clamp(own.velocity_W_mps.dot(*way.direction_W) / speed_mps, -1.0, 1.0));
    wanted_mps *= std::max(0.0, 1.0 - bend_rad / kBend_rad);
  }
  command.velocity_W_mps = wanted_mps * *way.direction_W;
  return command;
}

}  // namespace flight_corridor::sim
