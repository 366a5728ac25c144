#include <gtest/gtest.h>

#include <cmath>

#include "flight_corridor/corridor/safe_speed.hpp"
#include "sim/quadrotor.hpp"
#include "sim/random.hpp"

namespace flight_corridor::sim {
namespace {

const Eigen::Vector3d kStart_W(1.0, 2.0, 1.5);

TEST(Quadrotor, HoversUntilItIsCommanded) {
  Quadrotor quadrotor({}, kStart_W, 0.3);
  quadrotor.flyUntil(2.0);
  EXPECT_NEAR(quadrotor.time_s(), 2.0, 1e-9);
  EXPECT_TRUE(quadrotor.T_W_B().translation().isApprox(kStart_W));
  EXPECT_TRUE(quadrotor.T_W_B().linear().isApprox(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix()));
}

TEST(Quadrotor, FollowsACommandAfterItsLatency) {
  Quadrotor quadrotor({}, kStart_W, 0.0);
  quadrotor.command({{1.0, 0.0, 0.0}, 0.5});
  quadrotor.flyUntil(0.099);
  EXPECT_TRUE(quadrotor.velocity_W_mps().isZero());
  quadrotor.flyUntil(0.15);
  EXPECT_GT(quadrotor.velocity_W_mps().x(), 0.0);
  quadrotor.flyUntil(3.0);
  EXPECT_TRUE(quadrotor.velocity_W_mps().isApprox(Eigen::Vector3d(1.0, 0.0, 0.0), 1e-3));
}

TEST(Quadrotor, StaysWithinAccelerationJerkAndYawRate) {
  QuadrotorLimits limits;
  Quadrotor quadrotor(limits, kStart_W, 0.0);
  Random random(7, Stream::Scene);
  Eigen::Vector3d before_mps2 = Eigen::Vector3d::Zero();
  double heading_rad = 0.0;
  constexpr double kStep_s = 0.01;
  for (double time_s = kStep_s; time_s < 40.0; time_s += kStep_s) {
    if (random.chance(0.02)) {
      const Eigen::Vector3d velocity{random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-1, 1)};
      quadrotor.command({velocity, random.uniform(-3.0, 3.0)});
    }
    quadrotor.flyUntil(time_s);
    EXPECT_LE(quadrotor.acceleration_W_mps2().norm(), limits.acceleration_mps2 + 1e-9) << time_s;
    EXPECT_LE((quadrotor.acceleration_W_mps2() - before_mps2).norm(), 1.01 * limits.jerk_mps3 * kStep_s) << time_s;
    const Eigen::Isometry3d T_W_B = quadrotor.T_W_B();
    const double now_rad = std::atan2(T_W_B(1, 0), T_W_B(0, 0));
    // The nose's heading also moves a little by the tilt: by at most jerk / g times the tilt, 0.8 * 0.3 rad/s.
    EXPECT_LE(std::abs(std::remainder(now_rad - heading_rad, 2.0 * M_PI)), kStep_s * (limits.yaw_rate_rad_s + 0.3));
    before_mps2 = quadrotor.acceleration_W_mps2();
    heading_rad = now_rad;
  }
}

TEST(Quadrotor, ReachesAVelocityWithoutOvershoot) {
  for (const double speed_mps : {0.2, 1.0, 3.0, 6.0}) {
    Quadrotor quadrotor({}, kStart_W, 0.0);
    quadrotor.command({{speed_mps, 0.0, 0.0}, 0.0});
    double top_mps = 0.0;
    for (double time_s = 0.0; time_s < 6.0; time_s += 0.01) {
      quadrotor.flyUntil(time_s);
      top_mps = std::max(top_mps, quadrotor.velocity_W_mps().x());
    }
    EXPECT_LT(top_mps, speed_mps + 0.02) << speed_mps;
    EXPECT_NEAR(quadrotor.velocity_W_mps().x(), speed_mps, 1e-3);
  }
}

TEST(Quadrotor, TiltsTowardsWhereItAccelerates) {
  Quadrotor quadrotor({}, kStart_W, 1.0);
  quadrotor.command({{4.0, 0.0, 0.0}, 0.0});
  quadrotor.flyUntil(0.8);
  const Eigen::Isometry3d T_W_B = quadrotor.T_W_B();
  EXPECT_NEAR(quadrotor.acceleration_W_mps2().x(), 3.0, 1e-6);
  EXPECT_NEAR(std::acos(T_W_B(2, 2)), std::atan(3.0 / 9.80665), 1e-6);
  EXPECT_GT(T_W_B(0, 2), 0.0);
  EXPECT_NEAR(T_W_B.linear().determinant(), 1.0, 1e-9);
}

/// A quadrotor that flies along x at the safe speed of what is free before it, as it hears of it: at a camera's rate,
/// late by its processing, and no farther than the corridor is long.
class Approach {
 public:
  Approach(double acceleration_mps2, double jerk_mps3, Random& random) {
    speed_.acceleration_mps2 = limits_.acceleration_mps2 = acceleration_mps2;
    speed_.jerk_mps3 = limits_.jerk_mps3 = jerk_mps3;
    speed_.delay_s = limits_.latency_s = random.uniform(0.0, 0.3);
    length_m_ = random.uniform(2.0, 8.0);
    wall_m_ = random.uniform(0.5, 15.0);
    period_s_ = 1.0 / random.uniform(8.0, 30.0);
    processing_s_ = random.uniform(0.01, 0.08);
    quadrotor_ = Quadrotor(limits_, Eigen::Vector3d::Zero(), 0.0);
  }

  /// One pair, and what it makes the quadrotor do until the next.
  void look(double wall_m) {
    free_until_m_ = std::min(x_m() + length_m_, wall_m);
    const double wanted_mps = safeSpeed(free_until_m_ - x_m(), processing_s_ + period_s_, speed_);
    const double now_s = quadrotor_.time_s();
    fly(now_s + processing_s_);
    quadrotor_.command({{wanted_mps, 0.0, 0.0}, 0.0});
    fly(now_s + period_s_);
  }

  double x_m() const { return quadrotor_.T_W_B().translation().x(); }
  double speed_mps() const { return quadrotor_.velocity_W_mps().x(); }
  double wall_m() const { return wall_m_; }
  double freeUntil() const { return free_until_m_; }
  double margin() const { return speed_.margin_m; }

 private:
  void fly(double until_s) {
    if (until_s > quadrotor_.time_s()) quadrotor_.flyUntil(until_s);
  }

  QuadrotorLimits limits_;
  SpeedConfig speed_;
  double length_m_, wall_m_, period_s_, processing_s_, free_until_m_ = 0.0;
  Quadrotor quadrotor_{limits_, Eigen::Vector3d::Zero(), 0.0};
};

TEST(SafeSpeed, StopsBeforeAWallWithTheMarginLeft) {
  Random random(1, Stream::Scene);
  for (int i = 0; i < 200; ++i) {
    Approach approach(3.0, 8.0, random);
    double nearest_m = kInfinity;
    for (int pair = 0; pair < 600; ++pair) {
      approach.look(approach.wall_m());
      nearest_m = std::min(nearest_m, approach.wall_m() - approach.x_m());
    }
    EXPECT_GE(nearest_m, approach.margin() - 1e-6) << i;
    EXPECT_LT(approach.speed_mps(), 0.05) << i;
    EXPECT_LT(nearest_m, std::max(approach.margin() + 0.2, 0.6)) << i;  // it does get there
  }
}

TEST(SafeSpeed, WhatAppearsNoNearerThanWhatWasFreeIsNotReached) {
  Random random(2, Stream::Scene);
  for (int i = 0; i < 200; ++i) {
    Approach approach(3.0, 8.0, random);
    const int appears = static_cast<int>(random.uniform(1.0, 100.0));
    for (int pair = 0; pair < appears; ++pair) approach.look(approach.wall_m());
    const double end_m = approach.freeUntil();  // a wall right behind it
    double nearest_m = kInfinity;
    for (int pair = 0; pair < 400; ++pair) {
      approach.look(end_m);
      nearest_m = std::min(nearest_m, end_m - approach.x_m());
    }
    EXPECT_GE(nearest_m, approach.margin() - 1e-6) << i;
  }
}

/// The law takes no count of what speed still rises by while the acceleration turns round; the margin covers it.
TEST(SafeSpeed, TheStopIsWithinWhatWasFreeWhateverTheLimits) {
  Random random(3, Stream::Scene);
  for (int i = 0; i < 200; ++i) {
    const double acceleration_mps2 = random.uniform(1.5, 6.0);
    const double jerk_mps3 = random.uniform(4.0, 20.0);
    Approach approach(acceleration_mps2, jerk_mps3, random);
    for (int pair = 0; pair < 600; ++pair) {
      approach.look(approach.wall_m());
      EXPECT_GT(approach.wall_m() - approach.x_m(), 0.0) << i;
    }
  }
}

}  // namespace
}  // namespace flight_corridor::sim
