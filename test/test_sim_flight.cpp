#include <gtest/gtest.h>

#include <cmath>

#include "sim/flight.hpp"

namespace flight_corridor::sim {
namespace {

Flight steadyFlight() {
  Flight flight;
  flight.wobble_rad.setZero();
  flight.sway_m.setZero();
  return flight;
}

TEST(Flight, CoversTheDistanceAtTheSpeedBetweenItsRamps) {
  Flight flight = steadyFlight();
  flight.speed_m_s = 1.3;
  flight.duration_s = durationOver(6.5, flight.speed_m_s, flight.ramp_s);
  const auto x = [&](double time_s) { return flight.T_W_B(time_s).translation().x(); };
  EXPECT_NEAR(x(flight.duration_s) - x(0.0), 6.5, 1e-9);
  EXPECT_NEAR((x(3.01) - x(2.99)) / 0.02, 1.3, 1e-9);
}

TEST(Flight, NeverJumps) {
  const Flight flight;
  for (double time_s = -0.5; time_s < flight.duration_s + 0.5; time_s += 0.01) {
    const Eigen::Isometry3d step = flight.T_W_B(time_s).inverse() * flight.T_W_B(time_s + 0.01);
    // Speed plus sway: 2 pi * 0.66 Hz * (0.7 + 0.3 * 2.3) * 0.04 m < 0.25 m/s; wobble likewise below 0.4 rad/s.
    EXPECT_LT(step.translation().norm(), 0.01 * (flight.speed_m_s + 0.25)) << time_s;
    EXPECT_LT(Eigen::AngleAxisd(step.linear()).angle(), 0.01 * 0.4) << time_s;
  }
}

TEST(Flight, StandsStillBeforeItsStartAndAfterItsEnd) {
  const Flight flight;
  EXPECT_TRUE(flight.T_W_B(-3.0).isApprox(flight.T_W_B(0.0)));
  EXPECT_TRUE(flight.T_W_B(flight.duration_s + 3.0).isApprox(flight.T_W_B(flight.duration_s)));
}

TEST(Flight, WobblesWithinItsLimits) {
  Flight flight;
  flight.wobble_rad = {0.0, 0.0, 0.02};
  double largest_rad = 0.0;
  for (double time_s = 0.0; time_s < flight.duration_s; time_s += 0.02) {
    largest_rad = std::max(largest_rad, Eigen::AngleAxisd(flight.T_W_B(time_s).linear()).angle());
  }
  EXPECT_LE(largest_rad, 0.02);
  EXPECT_GE(largest_rad, 0.01);
}

TEST(Flight, ASidestepMovesItsLineAndNothingElse) {
  Flight straight = steadyFlight(), around = steadyFlight();
  around.sidesteps = {{2.0, 1.5, 1.4}, {5.0, 1.0, -0.4}};
  const auto shift = [&](double time_s) -> Eigen::Vector3d {
    return around.T_W_B(time_s).translation() - straight.T_W_B(time_s).translation();
  };
  EXPECT_TRUE(shift(1.99).isZero(1e-12));
  EXPECT_TRUE(shift(3.5).isApprox(Eigen::Vector3d(0.0, 1.4, 0.0)));
  EXPECT_TRUE(shift(6.0).isApprox(Eigen::Vector3d(0.0, 1.0, 0.0)));
  for (double time_s = 0.0; time_s < 7.0; time_s += 0.01) {
    // At most twice the mean speed.
    EXPECT_LE((shift(time_s + 0.01) - shift(time_s)).norm(), 0.01 * 2.0 * 1.4 / 1.5 + 1e-9) << time_s;
  }
}

Flight weavingFlight() {
  Flight flight = steadyFlight();
  flight.speed_m_s = 2.0;
  flight.turns = {turnAt(1.0, 0.7, 1.05), turnAt(2.4, -1.4, 1.05)};
  flight.sidesteps = {{1.5, 2.0, 0.0, 0.8}};
  return flight;
}

/// Of the body's x axis.
double headingOf(const Eigen::Isometry3d& T_W_B) { return std::atan2(T_W_B(1, 0), T_W_B(0, 0)); }

TEST(Flight, TurnsByTheAngleAtNoMoreThanTheRate) {
  const Flight flight = weavingFlight();
  EXPECT_NEAR(headingOf(flight.T_W_B(0.9)), 0.0, 1e-9);
  EXPECT_NEAR(headingOf(flight.T_W_B(2.4)), 0.7, 1e-9);
  EXPECT_NEAR(headingOf(flight.T_W_B(5.5)), -0.7, 1e-9);
  double fastest_rad_s = 0.0;
  for (double time_s = 0.0; time_s < flight.duration_s; time_s += 0.01) {
    const double turned_rad = headingOf(flight.T_W_B(time_s).inverse() * flight.T_W_B(time_s + 0.01));
    fastest_rad_s = std::max(fastest_rad_s, std::abs(turned_rad) / 0.01);
  }
  EXPECT_NEAR(fastest_rad_s, 1.05, 1e-3);
}

TEST(Flight, FollowsItsHeading) {
  const Flight flight = weavingFlight();
  for (double time_s = 1.0; time_s < 6.0; time_s += 0.05) {
    constexpr double kStep_s = 1e-3;
    const Eigen::Vector3d moved_W =
        flight.T_W_B(time_s + kStep_s).translation() - flight.T_W_B(time_s - kStep_s).translation();
    EXPECT_NEAR(moved_W.head<2>().norm() / (2.0 * kStep_s), 2.0, 1e-3) << time_s;
    // The heading moves by 1.05 rad/s * 1 ms at most.
    EXPECT_NEAR(std::atan2(moved_W.y(), moved_W.x()), headingOf(flight.T_W_B(time_s)), 2e-3) << time_s;
  }
}

TEST(Flight, ATurnOnTheSpotStaysThere) {
  Flight flight = steadyFlight();
  flight.speed_m_s = 0.0;
  flight.turns = {turnAt(1.0, -2.0, 1.2)};
  EXPECT_TRUE(flight.T_W_B(6.0).translation().isApprox(flight.start_W));
  EXPECT_NEAR(headingOf(flight.T_W_B(6.0)), -2.0, 1e-9);
}

TEST(Flight, YawsToAndFroWithoutLeavingItsLine) {
  Flight straight = weavingFlight();
  straight.tilts = true;
  Flight yawing = straight;
  yawing.body_yaws = yawSweep(0.4, 6.6, 0.4, 1.05);
  double fastest_rad_s = 0.0, leftmost_rad = 0.0, rightmost_rad = 0.0;
  const auto yaw = [&](double time_s) { return headingOf(straight.T_W_B(time_s).inverse() * yawing.T_W_B(time_s)); };
  for (double time_s = 0.0; time_s < straight.duration_s; time_s += 0.01) {
    EXPECT_TRUE(yawing.T_W_B(time_s).translation().isApprox(straight.T_W_B(time_s).translation())) << time_s;
    EXPECT_TRUE(yawing.T_W_B(time_s).linear().col(2).isApprox(straight.T_W_B(time_s).linear().col(2))) << time_s;
    fastest_rad_s = std::max(fastest_rad_s, std::abs(yaw(time_s + 0.01) - yaw(time_s)) / 0.01);
    leftmost_rad = std::max(leftmost_rad, yaw(time_s));
    rightmost_rad = std::min(rightmost_rad, yaw(time_s));
  }
  EXPECT_NEAR(fastest_rad_s, 1.05, 1e-3);
  EXPECT_NEAR(leftmost_rad, 0.4, 1e-3);
  EXPECT_NEAR(rightmost_rad, -0.4, 1e-3);
  EXPECT_NEAR(yaw(0.4), 0.0, 1e-9);
  EXPECT_NEAR(yaw(6.6), 0.0, 1e-9);
}

TEST(Flight, HasNoTimeToYawInAMoment) { EXPECT_TRUE(yawSweep(0.4, 1.0, 0.4, 1.05).empty()); }

TEST(Flight, ASidestepUpClimbs) {
  const Flight flight = weavingFlight();
  EXPECT_NEAR(flight.T_W_B(1.5).translation().z(), 1.5, 1e-9);
  EXPECT_NEAR(flight.T_W_B(3.5).translation().z(), 2.3, 1e-9);
}

TEST(Flight, TiltsTowardsWhereItAccelerates) {
  Flight flight = weavingFlight();
  flight.sidesteps.clear();
  flight.tilts = true;
  double steepest_rad = 0.0;
  for (double time_s = 0.2; time_s < flight.duration_s - 0.2; time_s += 0.05) {
    constexpr double kStep_s = 0.01;
    const auto p_W = [&](double at_s) -> Eigen::Vector3d { return flight.T_W_B(at_s).translation(); };
    const Eigen::Vector3d acceleration_W =
        (p_W(time_s - kStep_s) - 2.0 * p_W(time_s) + p_W(time_s + kStep_s)) / (kStep_s * kStep_s);
    const Eigen::Vector3d up_W = flight.T_W_B(time_s).linear().col(2);
    EXPECT_TRUE(up_W.isApprox((acceleration_W + Eigen::Vector3d(0.0, 0.0, 9.80665)).normalized(), 1e-3)) << time_s;
    if (2.4 < time_s && time_s < 5.0) steepest_rad = std::max(steepest_rad, std::acos(up_W.z()));
  }
  EXPECT_NEAR(steepest_rad, std::atan(2.0 * 1.05 / 9.80665), 0.01);  // v times the yaw rate, inwards
}

TEST(Flight, StaysSmoothThroughItsTurns) {
  Flight flight = weavingFlight();
  flight.tilts = true;
  for (double time_s = 0.0; time_s < flight.duration_s; time_s += 0.005) {
    const Eigen::Isometry3d step = flight.T_W_B(time_s).inverse() * flight.T_W_B(time_s + 0.005);
    EXPECT_LT(step.translation().norm(), 0.005 * 2.3) << time_s;
    EXPECT_LT(Eigen::AngleAxisd(step.linear()).angle(), 0.005 * 2.5) << time_s;
  }
}

}  // namespace
}  // namespace flight_corridor::sim
