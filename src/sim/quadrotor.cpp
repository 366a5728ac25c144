#include "sim/quadrotor.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor::sim {
namespace {

constexpr double kStep_s = 0.002;
constexpr double kGravity_mps2 = 9.80665;

/// Shortened to a length at most.
Eigen::Vector3d within(double length, const Eigen::Vector3d& v) {
  return v.norm() > length ? v.normalized() * length : v;
}

}  // namespace

Quadrotor::Quadrotor(const QuadrotorLimits& limits, const Eigen::Vector3d& p_W, double heading_rad)
    : limits_(limits), commands_{{0.0, {}}}, p_W_(p_W), heading_rad_(heading_rad) {}

void Quadrotor::flyUntil(double time_s) {
  while (time_s_ < time_s) step(std::min(kStep_s, time_s - time_s_));
}

/// Of the velocity that is missing: the acceleration from which the jerk still ends where the velocity is reached,
/// a = sqrt(2 j |e|).
void Quadrotor::step(double step_s) {
  while (commands_.size() > 1 && commands_[1].from_s <= time_s_) commands_.pop_front();
  const VelocityCommand& wanted = commands_.front().command;
  const Eigen::Vector3d missing_W = wanted.velocity_W_mps - velocity_W_;
  const double brisk_mps2 = std::min(
      {limits_.acceleration_mps2, std::sqrt(2.0 * limits_.jerk_mps3 * missing_W.norm()), missing_W.norm() / step_s});
  const Eigen::Vector3d aim_W = brisk_mps2 * missing_W.stableNormalized();
  acceleration_W_ += within(limits_.jerk_mps3 * step_s, aim_W - acceleration_W_);
  velocity_W_ += acceleration_W_ * step_s;
  p_W_ += velocity_W_ * step_s;

  const double rate_rad_s = std::clamp(wanted.yaw_rate_rad_s, -limits_.yaw_rate_rad_s, limits_.yaw_rate_rad_s);
  const double change_rad_s = limits_.yaw_acceleration_rad_s2 * step_s;
  yaw_rate_rad_s_ += std::clamp(rate_rad_s - yaw_rate_rad_s_, -change_rad_s, change_rad_s);
  heading_rad_ += yaw_rate_rad_s_ * step_s;
  time_s_ += step_s;
}

Eigen::Isometry3d Quadrotor::T_W_B() const {
  const Eigen::Vector3d up_W = (acceleration_W_ + kGravity_mps2 * Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d ahead_W(std::cos(heading_rad_), std::sin(heading_rad_), 0.0);
  Eigen::Isometry3d T_W_B = Eigen::Isometry3d::Identity();
  T_W_B.translation() = p_W_;
  T_W_B.linear().col(1) = up_W.cross(ahead_W).normalized();
  T_W_B.linear().col(0) = T_W_B.linear().col(1).cross(up_W);
  T_W_B.linear().col(2) = up_W;
  return T_W_B;
}

}  // namespace flight_corridor::sim
