#include <gtest/gtest.h>

#include <cmath>

#include "sim/policy.hpp"

namespace flight_corridor::sim {
namespace {

const Eigen::Vector3d kGoal_W(20.0, 0.0, 1.5);
constexpr double kAge_s = 0.15;

OwnState at(double heading_rad, const Eigen::Vector3d& velocity_W = Eigen::Vector3d::Zero()) {
  OwnState own;
  own.T_W_B.rotate(Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ()));
  own.velocity_W_mps = velocity_W;
  return own;
}

Way wayAlong(double yaw_rad, double free_m, double free_ahead_m = 4.0) {
  return {Eigen::Vector3d(std::cos(yaw_rad), std::sin(yaw_rad), 0.0), free_m, free_ahead_m};
}

TEST(Policy, FliesAlongTheWayAtItsSafeSpeed) {
  const SpeedConfig speed;
  const VelocityCommand command = Policy(speed, kAge_s).decide(at(0.0), wayAlong(0.2, 3.0), kGoal_W);
  EXPECT_NEAR(command.velocity_W_mps.norm(), safeSpeed(3.0, kAge_s, speed), 1e-9);
  EXPECT_NEAR(std::atan2(command.velocity_W_mps.y(), command.velocity_W_mps.x()), 0.2, 1e-9);
  EXPECT_GT(command.yaw_rate_rad_s, 0.0);
}

TEST(Policy, BrakesWhereItMovesToWhereNothingIsKnownToBeFree) {
  Policy policy({}, kAge_s);
  const OwnState fast = at(0.0, {2.0, 0.0, 0.0});
  EXPECT_TRUE(policy.decide(fast, wayAlong(0.0, 4.0, 0.5), kGoal_W).velocity_W_mps.isZero());
  EXPECT_GT(policy.decide(fast, wayAlong(0.0, 4.0, 4.0), kGoal_W).velocity_W_mps.x(), 2.0);
}

TEST(Policy, StopsBeforeASharpBend) {
  Policy policy({}, kAge_s);
  const OwnState fast = at(0.0, {2.0, 0.0, 0.0});
  const double slight = policy.decide(fast, wayAlong(0.1, 4.0), kGoal_W).velocity_W_mps.norm();
  EXPECT_LT(slight, policy.decide(fast, wayAlong(0.0, 4.0), kGoal_W).velocity_W_mps.norm());
  EXPECT_GT(slight, 1.0);
  EXPECT_EQ(policy.decide(fast, wayAlong(0.7, 4.0), kGoal_W).velocity_W_mps.norm(), 0.0);
}

TEST(Policy, TurnsOnTheSpotTowardsTheGoalAndKeepsTheSense) {
  Policy policy({}, kAge_s);
  const VelocityCommand first = policy.decide(at(0.5), {}, kGoal_W);
  EXPECT_TRUE(first.velocity_W_mps.isZero());
  EXPECT_LT(first.yaw_rate_rad_s, 0.0);                                 // the goal is to the right
  EXPECT_LT(policy.decide(at(-0.5), {}, kGoal_W).yaw_rate_rad_s, 0.0);  // now to the left
  policy.decide(at(-0.5), wayAlong(-0.5, 4.0), kGoal_W);
  EXPECT_GT(policy.decide(at(-0.5), {}, kGoal_W).yaw_rate_rad_s, 0.0);
}

TEST(YawTo, GoesTheShortWayRound) {
  EXPECT_NEAR(yawTo(at(3.0).T_W_B, {std::cos(-3.0), std::sin(-3.0), 0.0}), 2.0 * M_PI - 6.0, 1e-9);
  EXPECT_NEAR(yawTo(at(0.2).T_W_B, {0.0, 1.0, 0.5}), M_PI / 2.0 - 0.2, 1e-9);
}

}  // namespace
}  // namespace flight_corridor::sim
