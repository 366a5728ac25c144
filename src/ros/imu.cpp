#include "ros/imu.hpp"

#include <ros/console.h>

namespace flight_corridor_ros {

namespace {

const Eigen::Vector3d kGravity_W_mps2(0.0, 0.0, -9.80665);  // standard gravity
constexpr double kLargestForce_mps2 = 300.0;                // an imu of +-16 g on each axis ends below
constexpr double kSoon_s = 0.05;                            // tf's next pose; at 1 rad/s gravity is 0.5 m/s^2 off then
constexpr double kLargestRate_rad_s = 100.0;                // one of +-2000 deg/s, too

std::optional<Eigen::Vector3d> possible(const geometry_msgs::Vector3& message, double covariance, double largest) {
  const Eigen::Vector3d vector(message.x, message.y, message.z);
  const bool is_given = covariance != -1.0;
  if (!(is_given && vector.norm() <= largest)) return std::nullopt;
  return vector;
}

}  // namespace

std::optional<Eigen::Vector3d> toForce(const sensor_msgs::Imu& message) {
  return possible(message.linear_acceleration, message.linear_acceleration_covariance[0], kLargestForce_mps2);
}

std::optional<Eigen::Vector3d> toRate(const sensor_msgs::Imu& message) {
  return possible(message.angular_velocity, message.angular_velocity_covariance[0], kLargestRate_rad_s);
}

std::optional<Eigen::Vector3d> toAcceleration(const sensor_msgs::Imu& message, const Eigen::Matrix3d& R_I_W) {
  const auto force_I = toForce(message);
  if (!force_I) return std::nullopt;
  return *force_I + R_I_W * kGravity_W_mps2;
}

std::optional<Eigen::Vector3d> Accelerometer::read(const sensor_msgs::Imu& message, const std::string& camera_frame) {
  const auto R_C_I = mounting(camera_frame, message.header.frame_id);
  if (!R_C_I) return std::nullopt;
  const auto R_I_W = attitude(message.header);
  if (!R_I_W) return std::nullopt;
  const auto acceleration_I = toAcceleration(message, *R_I_W);
  if (acceleration_I) return *R_C_I * *acceleration_I;
  if (warning_.due()) {
    ROS_WARN(
        "imu \"%s\" gives no acceleration (NaN, above %.0f m/s^2, or covariance -1), so it is not used: see that its "
        "driver fills in linear_acceleration",
        message.header.frame_id.c_str(), kLargestForce_mps2);
  }
  return std::nullopt;
}

/// How the imu is turned against the camera, R_C_I: what tf says now.
std::optional<Eigen::Matrix3d> Accelerometer::mounting(const std::string& camera_frame, const std::string& imu_frame) {
  if (const auto T_C_I = transforms_.find(camera_frame, imu_frame, ros::Time(0))) return T_C_I->linear();
  if (warning_.due()) {
    ROS_WARN(
        "tf knows no pose of imu \"%s\" in \"%s\", so it is not used: publish it, e.g. with tf2_ros "
        "static_transform_publisher",
        imu_frame.c_str(), camera_frame.c_str());
  }
  return std::nullopt;
}

/// R_I_W at a reading's stamp, or shortly before it if tf knows none after it yet: never waits for it.
std::optional<Eigen::Matrix3d> Accelerometer::attitude(const std_msgs::Header& header) {
  if (const auto T_I_W = transforms_.find(header.frame_id, gravity_frame_, header.stamp, 0.0, kSoon_s)) {
    return T_I_W->linear();
  }
  if (warning_.due()) {
    ROS_WARN(
        "tf gave no attitude of imu \"%s\" in \"%s\" (ros/gravity_frame) at %.3f, nor within %.2f s, in time, so this "
        "reading is not used: publish it, or set ros/gravity_frame to a fixed frame, z up, that tf has",
        header.frame_id.c_str(), gravity_frame_.c_str(), header.stamp.toSec(), kSoon_s);
  }
  return std::nullopt;
}

}  // namespace flight_corridor_ros
