#include "ros/up_direction.hpp"

#include <ros/console.h>

#include <Eigen/Geometry>
#include <cmath>

namespace flight_corridor_ros {

namespace {

constexpr double kLeastHeading = 0.17;  // sine of 10 degrees off the vertical
constexpr double kNear_s = 0.1;         // at 1 rad/s an attitude of then is 6 degrees off
constexpr double kUnitNorm = 0.01;      // rounding in a quaternion

}  // namespace

std::optional<Eigen::Matrix3d> levelled(const Eigen::Matrix3d& R_C_F, const Eigen::Vector3d& up_C) {
  const Eigen::Vector3d forward_C = R_C_F.col(0), level_C = forward_C - forward_C.dot(up_C) * up_C;
  if (!(level_C.norm() >= kLeastHeading)) return std::nullopt;
  Eigen::Matrix3d R_C_H;
  R_C_H.col(0) = level_C.normalized();
  R_C_H.col(1) = up_C.cross(R_C_H.col(0));
  R_C_H.col(2) = up_C;
  return R_C_H;
}

std::optional<Eigen::Vector3d> toUp(const sensor_msgs::Imu& message) {
  const auto& q = message.orientation;
  const Eigen::Quaterniond R_W_I(q.w, q.x, q.y, q.z);
  const bool is_given = message.orientation_covariance[0] != -1.0;
  if (!(is_given && std::abs(R_W_I.norm() - 1.0) <= kUnitNorm)) return std::nullopt;
  return R_W_I.normalized().conjugate() * Eigen::Vector3d::UnitZ();
}

void UpDirection::add(const sensor_msgs::ImuConstPtr& imu) {
  if (toUp(*imu) && !(imu_ && imu->header.stamp < imu_->header.stamp)) imu_ = imu;
}

std::optional<Eigen::Vector3d> UpDirection::find(const std_msgs::Header& camera) {
  if (const auto up_C = byTf(camera, 0.0)) return up_C;
  if (const auto up_C = byImu(camera)) return up_C;
  const bool tf_knows_it = transforms_.find(camera.frame_id, gravity_frame_, ros::Time(0)).has_value();
  if (tf_knows_it) {
    if (const auto up_C = byTf(camera, tf_timeout_s_)) return up_C;
  }
  if (warning_.due()) {
    ROS_WARN(
        "the direction of up is unknown at %.3f: tf %s \"%s\" (ros/gravity_frame) to \"%s\", and there is no Imu with "
        "an orientation, and a mounting in tf, within %.1f s. A level corridor (corridor/level) is UNKNOWN, and every "
        "range of scan and obstacle_distance is NaN. Publish the attitude, or set ros/gravity_frame to a fixed frame, "
        "z up, that tf has",
        camera.stamp.toSec(), tf_knows_it ? "is late from" : "does not connect", gravity_frame_.c_str(),
        camera.frame_id.c_str(), kNear_s);
  }
  return std::nullopt;
}

std::optional<Eigen::Vector3d> UpDirection::byTf(const std_msgs::Header& camera, double timeout_s) const {
  const auto T_C_W = transforms_.find(camera.frame_id, gravity_frame_, camera.stamp, timeout_s);
  if (!T_C_W) return std::nullopt;
  return T_C_W->linear().col(2);
}

std::optional<Eigen::Vector3d> UpDirection::byImu(const std_msgs::Header& camera) const {
  if (!imu_ || !(std::abs(imu_->header.stamp.toSec() - camera.stamp.toSec()) <= kNear_s)) return std::nullopt;
  const auto T_C_I = transforms_.find(camera.frame_id, imu_->header.frame_id, ros::Time(0));
  if (!T_C_I) return std::nullopt;
  return T_C_I->linear() * *toUp(*imu_);
}

}  // namespace flight_corridor_ros
