#include <gtest/gtest.h>

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

}  // namespace
}  // namespace flight_corridor::sim
