#include <gtest/gtest.h>
#include <tf2_eigen/tf2_eigen.h>

#include <cmath>
#include <limits>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "ros/imu.hpp"

namespace flight_corridor_ros {
namespace {

constexpr double kGravity_mps2 = 9.80665;
constexpr double kTolerance_mps2 = 1e-9;  // of rotations, which are good to 1e-15 or so, times gravity

Eigen::Isometry3d turned(double roll, double pitch, double yaw) {
  return Eigen::Isometry3d(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                           Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                           Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()));
}

sensor_msgs::Imu imu(const Eigen::Vector3d& force_I, double stamp_s = 1.0) {
  sensor_msgs::Imu message;
  message.header.frame_id = "imu_link";
  message.header.stamp = ros::Time(stamp_s);
  tf2::toMsg(force_I, message.linear_acceleration);
  return message;
}

/// What an imu with this attitude measures when the body is accelerated in W.
Eigen::Vector3d specificForce(const Eigen::Isometry3d& T_W_I, const Eigen::Vector3d& acceleration_W) {
  return T_W_I.linear().transpose() * (acceleration_W + kGravity_mps2 * Eigen::Vector3d::UnitZ());
}

TEST(ToAcceleration, IsZeroAtRestInEveryAttitude) {
  for (const auto& T_W_I : {turned(0, 0, 0), turned(0.3, -0.2, 2.0), turned(M_PI, 0, 0), turned(0, M_PI / 2, 1)}) {
    const auto acceleration = toAcceleration(imu(specificForce(T_W_I, {0, 0, 0})), T_W_I.linear().transpose());
    ASSERT_TRUE(acceleration);
    EXPECT_NEAR(acceleration->norm(), 0.0, kTolerance_mps2) << T_W_I.matrix();
  }
}

TEST(ToAcceleration, IsWhatMovesTheImuInItsOwnFrame) {
  const Eigen::Isometry3d T_W_I = turned(0.1, -0.4, 0.7);
  const Eigen::Vector3d expected_I(2.0, -0.5, 0.3);
  const auto acceleration =
      toAcceleration(imu(specificForce(T_W_I, T_W_I.linear() * expected_I)), T_W_I.linear().transpose());
  ASSERT_TRUE(acceleration);
  EXPECT_NEAR((*acceleration - expected_I).norm(), 0.0, kTolerance_mps2);
}

TEST(ToAcceleration, RefusesWhatNoImuMeasures) {
  const Eigen::Matrix3d level = Eigen::Matrix3d::Identity();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double impossible : {std::nan(""), infinity, -infinity, 1e300, 301.0}) {
    EXPECT_FALSE(toAcceleration(imu({impossible, 0, kGravity_mps2}), level)) << impossible;
    EXPECT_FALSE(toAcceleration(imu({0, 0, impossible}), level)) << impossible;
  }
  EXPECT_TRUE(toAcceleration(imu({160, 160, 160}), level));
}

TEST(ToAcceleration, RefusesAMessageThatSaysItHoldsNone) {
  sensor_msgs::Imu message = imu({0, 0, kGravity_mps2});
  message.orientation_covariance[0] = message.angular_velocity_covariance[0] = -1.0;
  EXPECT_TRUE(toAcceleration(message, Eigen::Matrix3d::Identity()));
  message.linear_acceleration_covariance[0] = -1.0;
  EXPECT_FALSE(toAcceleration(message, Eigen::Matrix3d::Identity()));
}

class AccelerometerTest : public testing::Test {
 protected:
  void place(const std::string& parent, const std::string& child, const Eigen::Isometry3d& T_parent_child,
             double stamp_s, bool is_static) {
    geometry_msgs::TransformStamped message = tf2::eigenToTransform(T_parent_child);
    message.header.stamp = ros::Time(stamp_s);
    message.header.frame_id = parent;
    message.child_frame_id = child;
    transforms.add(message, is_static);
  }

  void mountCamera() { place("base_link", "camera", flight_corridor::opticalFromForward().inverse(), 0.0, true); }
  void mountImu(const Eigen::Isometry3d& T_B_I) { place("base_link", "imu_link", T_B_I, 0.0, true); }
  void fly(const Eigen::Isometry3d& T_W_B, double stamp_s) { place("odom", "base_link", T_W_B, stamp_s, false); }

  Transforms transforms;
  Accelerometer accelerometer{"odom", transforms};
};

TEST_F(AccelerometerTest, ForwardIsAlongTheCamerasOpticalAxisHoweverTheImuIsMounted) {
  const Eigen::Isometry3d T_W_B = turned(0.05, 0.2, -1.0), T_B_I = turned(M_PI, 0.1, M_PI / 2);
  mountCamera();
  mountImu(T_B_I);
  fly(T_W_B, 1.0);
  const Eigen::Vector3d acceleration_W = T_W_B.linear() * Eigen::Vector3d(1.5, 0, 0);
  const auto acceleration_C = accelerometer.read(imu(specificForce(T_W_B * T_B_I, acceleration_W)), "camera");
  ASSERT_TRUE(acceleration_C);
  EXPECT_NEAR((*acceleration_C - Eigen::Vector3d(0, 0, 1.5)).norm(), 0.0, kTolerance_mps2);
}

TEST_F(AccelerometerTest, GravityIsRemovedWithTheAttitudeAtTheReadingsStamp) {
  mountCamera();
  mountImu(Eigen::Isometry3d::Identity());
  fly(turned(0, 0.0, 0), 1.0);
  fly(turned(0, 0.2, 0), 2.0);
  const auto acceleration_C = accelerometer.read(imu(specificForce(turned(0, 0.1, 0), {0, 0, 0}), 1.5), "camera");
  ASSERT_TRUE(acceleration_C);
  EXPECT_NEAR(acceleration_C->norm(), 0.0, kTolerance_mps2);
}

TEST_F(AccelerometerTest, AnAttitudeThatIsNotThereIsNotWaitedFor) {
  const sensor_msgs::Imu at_rest = imu({0, 0, kGravity_mps2}, 1.5);
  mountCamera();
  mountImu(Eigen::Isometry3d::Identity());
  EXPECT_FALSE(accelerometer.read(at_rest, "camera"));
  fly(turned(0, 0, 0), 1.0);
  EXPECT_FALSE(accelerometer.read(at_rest, "camera"));
  fly(turned(0, 0, 0), 2.0);
  EXPECT_TRUE(accelerometer.read(at_rest, "camera"));
}

TEST_F(AccelerometerTest, AfterTheLastPoseOfTfItCountsUntilTheNextComes) {
  mountCamera();
  mountImu(Eigen::Isometry3d::Identity());
  const auto at_rest = [](double pitch, double stamp_s) {
    return imu(specificForce(turned(0, pitch, 0), {0, 0, 0}), stamp_s);
  };
  fly(turned(0, 0.2, 0), 1.0);
  const auto by_the_last = accelerometer.read(at_rest(0.2, 1.04), "camera");
  ASSERT_TRUE(by_the_last);
  EXPECT_NEAR(by_the_last->norm(), 0.0, kTolerance_mps2);
  EXPECT_FALSE(accelerometer.read(at_rest(0.2, 1.06), "camera"));
  fly(turned(0, 0.4, 0), 1.08);
  const auto between = accelerometer.read(at_rest(0.3, 1.04), "camera");
  ASSERT_TRUE(between);
  EXPECT_NEAR(between->norm(), 0.0, kTolerance_mps2);
}

TEST_F(AccelerometerTest, AnImuWithoutAPlaceIsNotUsedUntilTfKnowsIt) {
  const sensor_msgs::Imu at_rest = imu({0, 0, kGravity_mps2});
  mountCamera();
  fly(turned(0, 0, 0), 1.0);
  EXPECT_FALSE(accelerometer.read(at_rest, "camera"));
  mountImu(Eigen::Isometry3d::Identity());
  EXPECT_TRUE(accelerometer.read(at_rest, "camera"));
  sensor_msgs::Imu nameless = at_rest;
  nameless.header.frame_id = "";
  EXPECT_FALSE(accelerometer.read(nameless, "camera"));
}

TEST_F(AccelerometerTest, AnotherCameraHasItsOwnDirections) {
  mountCamera();
  mountImu(Eigen::Isometry3d::Identity());
  place("base_link", "forward_left_up", Eigen::Isometry3d::Identity(), 0.0, true);
  fly(turned(0, 0, 0), 1.0);
  const sensor_msgs::Imu forward = imu({1.0, 0, kGravity_mps2});
  EXPECT_NEAR(accelerometer.read(forward, "camera")->z(), 1.0, kTolerance_mps2);
  EXPECT_NEAR(accelerometer.read(forward, "forward_left_up")->x(), 1.0, kTolerance_mps2);
}

}  // namespace
}  // namespace flight_corridor_ros
