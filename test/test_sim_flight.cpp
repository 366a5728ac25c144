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

}  // namespace
}  // namespace flight_corridor::sim
