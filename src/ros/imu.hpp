#pragma once

#include <sensor_msgs/Imu.h>

#include <Eigen/Core>
#include <optional>
#include <string>

#include "ros/heartbeat.hpp"
#include "ros/transforms.hpp"

namespace flight_corridor_ros {

/// The specific force in the imu's frame [m/s^2].
/// @return nullopt if the message has none (covariance[0] = -1) or an impossible one: NaN, inf, above 300 m/s^2.
std::optional<Eigen::Vector3d> toForce(const sensor_msgs::Imu& message);

/// The angular velocity in the imu's frame [rad/s].
/// @return nullopt if the message has none (covariance[0] = -1) or an impossible one: NaN, inf, above 100 rad/s.
std::optional<Eigen::Vector3d> toRate(const sensor_msgs::Imu& message);

/// The imu's own acceleration in its frame I, gravity removed [m/s^2]. Model: a_I = f_I + R_I_W g_W, g_W = (0, 0,
/// -9.80665); an imu measures the specific force f.
/// @param R_I_W attitude: turns vectors of a fixed frame W, z up, into I.
/// @return nullopt if the message has no specific force.
std::optional<Eigen::Vector3d> toAcceleration(const sensor_msgs::Imu& message, const Eigen::Matrix3d& R_I_W);

/// Accelerations of the rig from imu messages and tf. One thread.
class Accelerometer {
 public:
  /// @param gravity_frame a fixed frame of tf, z up.
  Accelerometer(const std::string& gravity_frame, const Transforms& transforms)
      : gravity_frame_(gravity_frame), transforms_(transforms) {}

  /// The rig's acceleration in the camera's frame C, gravity removed [m/s^2]. The imu's position is neglected: 0.1 m
  /// off the camera and turning at 1 rad/s it measures 0.1 m/s^2 more, far below the range fusion's process noise.
  /// @return nullopt if the message has none, or if tf does not yet know the imu's attitude within 0.05 s of its stamp.
  std::optional<Eigen::Vector3d> read(const sensor_msgs::Imu& message, const std::string& camera_frame);

 private:
  std::optional<Eigen::Matrix3d> mounting(const std::string& camera_frame, const std::string& imu_frame);
  std::optional<Eigen::Matrix3d> attitude(const std_msgs::Header& header);

  std::string gravity_frame_;
  const Transforms& transforms_;
  Throttle warning_;
};

}  // namespace flight_corridor_ros
