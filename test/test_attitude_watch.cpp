#include <gtest/gtest.h>
#include <tf2_eigen/tf2_eigen.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "ros/attitude_watch.hpp"
#include "support/contains.hpp"

namespace flight_corridor_ros {
namespace {

using flight_corridor::test_support::contains;

constexpr double kGravity_mps2 = 9.80665, kPeriod_s = 0.005;

using Attitude = std::function<Eigen::Quaterniond(double now_s)>;       // R_W_I
using Acceleration = std::function<Eigen::Vector3d(double now_s)>;      // in W [m/s^2]
using Claim = std::function<Eigen::Quaterniond(Eigen::Quaterniond q)>;  // of the true attitude

Eigen::Quaterniond turned(double roll, double pitch, double yaw) {
  return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX());
}

Eigen::Vector3d still(double) { return Eigen::Vector3d::Zero(); }

/// What an imu measures in flight.
sensor_msgs::Imu measured(const Attitude& attitude, const Acceleration& acceleration, double now_s) {
  sensor_msgs::Imu message;
  message.header.stamp = ros::Time(100.0 + now_s);
  const Eigen::Quaterniond R_W_I = attitude(now_s);
  const Eigen::AngleAxisd turn(R_W_I.conjugate() * attitude(now_s + 1e-4));
  tf2::toMsg(Eigen::Vector3d(turn.axis() * turn.angle() / 1e-4), message.angular_velocity);
  tf2::toMsg(Eigen::Vector3d(R_W_I.conjugate() * (acceleration(now_s) + kGravity_mps2 * Eigen::Vector3d::UnitZ())),
             message.linear_acceleration);
  return message;
}

Eigen::Vector3d upBy(const Eigen::Quaterniond& R_W_I) { return R_W_I.conjugate() * Eigen::Vector3d::UnitZ(); }

/// The first contradiction in a flight of ten seconds, asked for 20 times a second; empty: none.
std::string contradictionIn(const Attitude& attitude, const Acceleration& acceleration, const Claim& claim) {
  AttitudeWatch watch;
  for (int i = 0; i < 2000; ++i) {
    const double now_s = kPeriod_s * i;
    watch.add(measured(attitude, acceleration, now_s), upBy(claim(attitude(now_s))));
    if (i % 10 != 0) continue;
    if (const auto found = watch.contradiction()) return *found + " at " + std::to_string(now_s);
  }
  return "";
}

Eigen::Quaterniond right(const Eigen::Quaterniond& q) { return q; }
Eigen::Quaterniond identity(const Eigen::Quaterniond&) { return Eigen::Quaterniond::Identity(); }
Eigen::Quaterniond inverse(const Eigen::Quaterniond& q) { return q.conjugate(); }
Eigen::Quaterniond wFirst(const Eigen::Quaterniond& q) { return {q.z(), q.w(), q.x(), q.y()}; }
Eigen::Quaterniond inNed(const Eigen::Quaterniond& q) { return turned(M_PI, 0.0, 0.0) * q; }
Eigen::Quaterniond inNedAndFrd(const Eigen::Quaterniond& q) { return turned(M_PI, 0, 0) * q * turned(M_PI, 0, 0); }
Eigen::Quaterniond onItsSide(const Eigen::Quaterniond& q) { return turned(M_PI_2, 0.0, 0.0) * q; }
Eigen::Quaterniond yawAlone(const Eigen::Quaterniond& q) {
  const Eigen::Vector3d ahead = q * Eigen::Vector3d::UnitX();
  return turned(0.0, 0.0, std::atan2(ahead.y(), ahead.x()));
}

Eigen::Quaterniond hover(double) { return turned(0.02, 0.03, 0.7); }
Eigen::Quaterniond banking(double now_s) {
  return turned(0.52 * std::sin(1.6 * now_s), 0.2 * std::sin(1.1 * now_s), 0.3);
}
Eigen::Quaterniond agile(double now_s) {
  return turned(0.7 * std::sin(4.0 * now_s), 0.4 * std::sin(3.0 * now_s), now_s);
}

// A level turn, banked by 40 degrees to the right at 5 m/s.
constexpr double kBank = 0.7, kTurn_rad_s = -1.652;  // g tan(bank) / speed
Eigen::Quaterniond circling(double now_s) { return turned(kBank, 0.0, kTurn_rad_s * now_s); }
Eigen::Vector3d centripetal(double now_s) {
  const double yaw = kTurn_rad_s * now_s;
  return kGravity_mps2 * std::tan(kBank) * Eigen::Vector3d(std::sin(yaw), -std::cos(yaw), 0.0);
}

TEST(AttitudeWatch, ARightAttitudeIsContradictedByNoFlight) {
  const auto shaken = [](double now_s) { return Eigen::Vector3d(15.0 * std::sin(500.0 * now_s), 0.0, 10.0); };
  const auto gusty = [](double now_s) { return Eigen::Vector3d(5.0 * std::sin(now_s), 5.0 * std::cos(now_s), -3.0); };
  const auto dashing = [](double) { return Eigen::Vector3d(5.0, 5.0, 0.0); };
  const auto falling = [](double) { return Eigen::Vector3d(1.0, 0.0, -9.0); };
  for (const Attitude& attitude : {Attitude(hover), Attitude(banking), Attitude(agile), Attitude(circling)}) {
    for (const Acceleration& acceleration : {Acceleration(still), Acceleration(shaken), Acceleration(gusty),
                                             Acceleration(dashing), Acceleration(falling)}) {
      EXPECT_EQ(contradictionIn(attitude, acceleration, right), "");
    }
  }
  EXPECT_EQ(contradictionIn(circling, centripetal, right), "");
}

TEST(AttitudeWatch, AnAttitudeThatComesLateAndAGyroThatDriftsAreNoContradiction) {
  AttitudeWatch watch;
  for (int i = 0; i < 2000; ++i) {
    const double now_s = kPeriod_s * i;
    sensor_msgs::Imu message = measured(agile, still, now_s);
    message.angular_velocity.x += 0.03;
    watch.add(message, upBy(agile(now_s - 0.05)));
    EXPECT_FALSE(watch.contradiction()) << now_s;
  }
}

TEST(AttitudeWatch, AnAttitudeUpsideDownOrOnItsSideIsContradictedByTheForce) {
  for (const Claim& claim : {Claim(inNed), Claim(onItsSide), Claim(wFirst)}) {
    for (const Attitude& attitude : {Attitude(hover), Attitude(banking)}) {
      const std::string found = contradictionIn(attitude, still, claim);
      EXPECT_TRUE(contains(found, "acceleration")) << found;
    }
  }
  const std::string found = contradictionIn([](double) { return turned(0, 0, 0.7); }, still, inNed);
  EXPECT_TRUE(contains(found, "by 180 deg (at most 60 deg) at 0.0")) << found;
}

TEST(AttitudeWatch, AnAttitudeThatDoesNotFollowTheTurnIsContradictedByTheRate) {
  for (const Claim& claim : {Claim(identity), Claim(yawAlone), Claim(inverse), Claim(inNedAndFrd)}) {
    EXPECT_TRUE(contains(contradictionIn(banking, still, claim), "angular velocity"));
  }
}

TEST(AttitudeWatch, AConstantAttitudeIsToldInATightTurnButNotInAWideOne) {
  const auto wide = [](double now_s) { return circling(0.2 * now_s); };  // at 25 m/s
  const auto to_its_middle = [](double now_s) { return centripetal(0.2 * now_s); };
  for (const Claim& claim : {Claim(identity), Claim(yawAlone)}) {
    EXPECT_TRUE(contains(contradictionIn(circling, centripetal, claim), "angular velocity"));
    EXPECT_EQ(contradictionIn(wide, to_its_middle, claim), "");
  }
}

TEST(AttitudeWatch, WhatWasContradictedForASecondIsNotBelievedForTenMore) {
  AttitudeWatch watch;
  double last_s = 0.0;
  for (int i = 0; i < 6000; ++i) {
    const double now_s = kPeriod_s * i;
    const sensor_msgs::Imu message = measured(hover, still, now_s);
    watch.add(message, upBy(now_s < 5.0 ? inNed(hover(now_s)) : hover(now_s)));
    if (watch.contradiction()) last_s = now_s;
    EXPECT_TRUE(now_s >= 5.0 || watch.contradiction()) << now_s;
  }
  EXPECT_NEAR(last_s, 5.0 + 1.0 + 10.0, 0.5);  // half of the window shows the new attitude
}

TEST(AttitudeWatch, OneWrongMessageIsNoContradiction) {
  const std::function<void(sensor_msgs::Imu&, Eigen::Vector3d&)> faults[] = {
      [](auto&, auto& up_I) { up_I = -up_I; },
      [](auto&, auto& up_I) { up_I = Eigen::Vector3d::UnitX(); },
      [](auto& imu, auto&) { imu.linear_acceleration.y = 290.0; },
      [](auto& imu, auto&) { imu.linear_acceleration.y = NAN; },
      [](auto& imu, auto&) { imu.angular_velocity.x = NAN; },
      [](auto& imu, auto&) { imu.angular_velocity.x = 1e9; },
      [](auto& imu, auto&) { imu.header.frame_id = "elsewhere"; },
      [](auto& imu, auto&) { imu.header.stamp = ros::Time(); },
      [](auto& imu, auto&) { imu.header.stamp += ros::Duration(1000.0); }};
  for (const auto& fault : faults) {
    AttitudeWatch watch;
    for (int i = 0; i < 2000; ++i) {
      sensor_msgs::Imu message = measured(banking, still, kPeriod_s * i);
      Eigen::Vector3d up_I = upBy(banking(kPeriod_s * i));
      if (i == 1000) fault(message, up_I);
      watch.add(message, up_I);
      EXPECT_FALSE(i != 1000 && watch.contradiction()) << i;
    }
  }
}

TEST(AttitudeWatch, AMessageWithoutForceAndRateContradictsNothing) {
  const auto found = [](const std::function<void(sensor_msgs::Imu&)>& change, const Claim& claim) {
    AttitudeWatch watch;
    for (int i = 0; i < 2000; ++i) {
      sensor_msgs::Imu message = measured(banking, still, kPeriod_s * i);
      change(message);
      watch.add(message, upBy(claim(banking(kPeriod_s * i))));
      if (watch.contradiction()) return true;
    }
    return false;
  };
  const auto no_force = [](sensor_msgs::Imu& imu) { imu.linear_acceleration_covariance[0] = -1.0; };
  const auto no_gravity = [](sensor_msgs::Imu& imu) { imu.linear_acceleration = geometry_msgs::Vector3(); };
  const auto no_rate = [](sensor_msgs::Imu& imu) { imu.angular_velocity_covariance[0] = -1.0; };
  const auto zero_rate = [](sensor_msgs::Imu& imu) { imu.angular_velocity = geometry_msgs::Vector3(); };
  EXPECT_FALSE(found(no_force, onItsSide));
  EXPECT_FALSE(found(no_gravity, onItsSide));
  EXPECT_FALSE(found(no_rate, identity));
  EXPECT_FALSE(found(zero_rate, identity));
  EXPECT_FALSE(found(no_rate, right));
  EXPECT_FALSE(found(zero_rate, right));
}

}  // namespace
}  // namespace flight_corridor_ros
