#include <gtest/gtest.h>
#include <tf2_eigen/tf2_eigen.h>

#include <cmath>
#include <string>

#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "ros/up_direction.hpp"
#include "support/contains.hpp"

namespace flight_corridor_ros {
namespace {

using flight_corridor::test_support::contains;

Eigen::Matrix3d turned(double roll, double pitch, double yaw) {
  return (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

TEST(Levelled, TakesRollAndPitchAndKeepsTheHeading) {
  const Eigen::Matrix3d R_C_B = flight_corridor::opticalFromForward().linear();
  for (const double yaw : {-2.0, 0.0, 1.0}) {
    const Eigen::Matrix3d R_W_B = turned(0.5, -0.4, yaw);
    const Eigen::Vector3d up_C = R_C_B * R_W_B.transpose() * Eigen::Vector3d::UnitZ();
    const auto R_C_H = levelled(R_C_B, up_C);
    ASSERT_TRUE(R_C_H);
    EXPECT_TRUE(flight_corridor::isRotation(*R_C_H));
    const Eigen::Matrix3d R_W_H = R_W_B * R_C_B.transpose() * *R_C_H;
    EXPECT_TRUE(R_W_H.isApprox(turned(0.0, 0.0, yaw), 1e-9)) << R_W_H;
  }
}

TEST(Levelled, WhatPointsStraightUpHasNoHeading) {
  const Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  EXPECT_FALSE(levelled(R, Eigen::Vector3d::UnitX()));
  EXPECT_FALSE(levelled(R, -Eigen::Vector3d::UnitX()));
  EXPECT_FALSE(levelled(R, Eigen::Vector3d::Constant(std::nan(""))));
  EXPECT_TRUE(levelled(R, turned(0.0, 1.2, 0.0).transpose() * Eigen::Vector3d::UnitZ()));
}

class UpDirectionTest : public testing::Test {
 protected:
  UpDirectionTest() {
    place("base_link", "camera", flight_corridor::opticalFromForward().linear().transpose(), ros::Time());
    camera.frame_id = "camera";
    camera.stamp = ros::Time(10.0);
  }

  void place(const std::string& parent, const std::string& child, const Eigen::Matrix3d& R_parent_child,
             const ros::Time& stamp) {
    geometry_msgs::TransformStamped message = tf2::eigenToTransform(Eigen::Isometry3d(R_parent_child));
    message.header.stamp = stamp;
    message.header.frame_id = parent;
    message.child_frame_id = child;
    transforms.add(message, stamp.isZero());
  }

  static sensor_msgs::ImuPtr imu(const Eigen::Matrix3d& R_W_I, double stamp_s) {
    const auto message = boost::make_shared<sensor_msgs::Imu>();
    message->header.frame_id = "imu_link";
    message->header.stamp = ros::Time(stamp_s);
    message->orientation = tf2::toMsg(Eigen::Quaterniond(R_W_I));
    return message;
  }

  /// Where up is, in the body's frame.
  Eigen::Vector3d up_B() {
    const auto up_C = up.find(camera);
    if (!up_C) return Eigen::Vector3d::Zero();
    return flight_corridor::opticalFromForward().linear().transpose() * *up_C;
  }

  Transforms transforms;
  UpDirection up{"odom", transforms, 0.02};
  std_msgs::Header camera;
};

TEST_F(UpDirectionTest, IsWhereTfSaysAtTheStamp) {
  place("odom", "base_link", turned(0.0, 0.0, 0.7), ros::Time(9.9));
  place("odom", "base_link", turned(0.2, 0.0, 0.7), ros::Time(10.1));
  EXPECT_TRUE(up_B().isApprox(turned(0.1, 0.0, 0.0).transpose() * Eigen::Vector3d::UnitZ(), 1e-6)) << up_B();
}

TEST_F(UpDirectionTest, IsWhereTheImuSaysWhereTfDoesNot) {
  const Eigen::Matrix3d R_B_I = turned(M_PI, 0.0, M_PI_2), R_W_B = turned(0.3, -0.2, 2.0);
  place("base_link", "imu_link", R_B_I, ros::Time());
  up.add(imu(R_W_B * R_B_I, 9.95));
  EXPECT_TRUE(up_B().isApprox(R_W_B.transpose() * Eigen::Vector3d::UnitZ(), 1e-6)) << up_B();
}

TEST_F(UpDirectionTest, AnImuWithoutAnAttitudeOrAPlaceOrOfAnotherTimeSaysNothing) {
  testing::internal::CaptureStderr();
  up.add(imu(turned(0, 0, 0), 9.95));
  EXPECT_FALSE(up.find(camera)) << "no mounting";
  EXPECT_TRUE(contains(testing::internal::GetCapturedStderr(), "the direction of up is unknown"));
  place("base_link", "imu_link", turned(0, 0, 0), ros::Time());
  EXPECT_TRUE(up.find(camera));
  camera.stamp += ros::Duration(0.2);
  EXPECT_FALSE(up.find(camera)) << "too old";

  const auto without = imu(turned(0, 0, 0), 10.2);
  without->orientation_covariance[0] = -1.0;
  up.add(without);
  EXPECT_FALSE(up.find(camera));
  const auto zero = imu(turned(0, 0, 0), 10.2);
  zero->orientation = geometry_msgs::Quaternion();
  up.add(zero);
  EXPECT_FALSE(up.find(camera));
  const auto nan = imu(turned(0, 0, 0), 10.2);
  nan->orientation.w = std::nan("");
  up.add(nan);
  EXPECT_FALSE(up.find(camera));
  up.add(imu(turned(0, 0, 0), 10.2));
  EXPECT_TRUE(up.find(camera));
  up.reset();
  EXPECT_FALSE(up.find(camera));
}

TEST_F(UpDirectionTest, AnOrientationThatTheForceContradictsIsNone) {
  place("base_link", "imu_link", turned(0, 0, 0), ros::Time());
  const auto shown = [&](const Eigen::Matrix3d& R_W_I) {
    up.reset();
    for (int i = -10; i <= 0; ++i) {
      const auto message = imu(R_W_I, 10.0 + 0.01 * i);
      message->linear_acceleration.z = 9.8;
      up.add(message);
    }
    return up_B();
  };
  EXPECT_TRUE(shown(turned(0, 0, 0.5)).isApprox(Eigen::Vector3d::UnitZ(), 1e-6));
  EXPECT_EQ(up.contradiction(), "");
  testing::internal::CaptureStderr();
  EXPECT_TRUE(shown(turned(M_PI, 0, 0.5)).isZero());
  const std::string log = testing::internal::GetCapturedStderr();
  for (const char* part : {"\"imu_link\"", "180 deg", "60 deg", "REP-145", "ENU"})
    EXPECT_TRUE(contains(log, part)) << log;
  EXPECT_TRUE(contains(up.contradiction(), "180 deg"));
}

TEST_F(UpDirectionTest, AnAttitudeByTfThatTheForceContradictsIsNone) {
  place("base_link", "imu_link", turned(0, 0, 0), ros::Time());
  const auto shown = [&](const Eigen::Matrix3d& R_W_B) {
    up.reset();
    for (int i = -10; i <= 0; ++i) {
      const double stamp_s = 10.0 + 0.01 * i;
      place("odom", "base_link", R_W_B, ros::Time(stamp_s));
      const auto message = imu(turned(0, 0, 0), stamp_s);
      message->linear_acceleration.z = 9.8;
      message->orientation_covariance[0] = -1.0;
      up.add(message);
    }
    return up_B();
  };
  testing::internal::CaptureStderr();
  EXPECT_TRUE(shown(turned(0, M_PI_2, 0)).isZero());
  EXPECT_TRUE(contains(testing::internal::GetCapturedStderr(), "\"odom\" (ros/gravity_frame)"));
}

TEST_F(UpDirectionTest, TfIsPreferredAndWaitedForWhereItIsKnownAtAll) {
  place("base_link", "imu_link", turned(0, 0, 0), ros::Time());
  place("odom", "base_link", turned(0.4, 0.0, 0.0), ros::Time(9.9));
  const ros::WallTime begin = ros::WallTime::now();
  EXPECT_FALSE(up.find(camera)) << "late";
  EXPECT_GE((ros::WallTime::now() - begin).toSec(), 0.02);
  up.add(imu(turned(0, 0, 0), 10.0));
  EXPECT_TRUE(up_B().isApprox(Eigen::Vector3d::UnitZ(), 1e-6)) << "the imu stands in";
  place("odom", "base_link", turned(0.4, 0.0, 0.0), ros::Time(10.0));
  EXPECT_TRUE(up_B().isApprox(turned(0.4, 0.0, 0.0).transpose() * Eigen::Vector3d::UnitZ(), 1e-6)) << up_B();
}

}  // namespace
}  // namespace flight_corridor_ros
