#include "ros/up_direction.hpp"

#include <ros/console.h>

#include <Eigen/Geometry>
#include <cmath>

namespace flight_corridor_ros {

namespace {

constexpr double kLeastHeading = 0.17;      // sine of 10 degrees off the vertical
constexpr double kNear_s = 0.1;             // at 1 rad/s an attitude of then is 6 degrees off
constexpr std::size_t kMostWaiting = 2000;  // two seconds of an imu at 1 kHz

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
  if (!is_given || !isUnit(R_W_I)) return std::nullopt;
  return R_W_I.normalized().conjugate() * Eigen::Vector3d::UnitZ();
}

void UpDirection::add(const sensor_msgs::ImuConstPtr& imu) {
  const auto up_I = toUp(*imu);
  if (up_I) imu_watch_.add(*imu, *up_I);
  if (up_I && !(imu_ && imu->header.stamp < imu_->header.stamp)) imu_ = imu;
  not_watched_.push_back(imu);
  if (not_watched_.size() > kMostWaiting) not_watched_.pop_front();
}

std::optional<Eigen::Vector3d> UpDirection::find(const std_msgs::Header& camera) {
  contradiction_.clear();
  std::optional<Eigen::Vector3d> up_C = byTf(camera, 0.0);
  bool is_by_tf = up_C.has_value();
  if (!up_C) up_C = byImu(camera);
  const bool tf_knows_it = up_C || transforms_.find(camera.frame_id, gravity_frame_, ros::Time(0));
  if (!up_C && tf_knows_it) {
    up_C = byTf(camera, tf_timeout_s_);
    is_by_tf = true;
  }
  if (!up_C) warnUnknown(camera, tf_knows_it);
  if (!up_C || isContradicted(is_by_tf)) return std::nullopt;
  return up_C;
}

void UpDirection::reset() {
  imu_.reset();
  not_watched_.clear();
  imu_watch_.reset();
  tf_watch_.reset();
  contradiction_.clear();
}

/// Whether what the imu measured contradicts tf, or the imu's own orientation.
bool UpDirection::isContradicted(bool is_by_tf) {
  if (is_by_tf) watchTf();
  const auto found = (is_by_tf ? tf_watch_ : imu_watch_).contradiction();
  const std::string source = is_by_tf ? "tf's attitude in \"" + gravity_frame_ + "\" (ros/gravity_frame)"
                                      : "the orientation of imu \"" + (imu_ ? imu_->header.frame_id : "") + "\"";
  contradiction_ = found ? source + ": " + *found : "";
  if (found && contradiction_warning_.due()) {
    ROS_ERROR(
        "%s. So the direction of up is unknown: a level corridor (corridor/level) is UNKNOWN, and every range of scan "
        "and obstacle_distance is NaN. Wanted are, by REP-103 and REP-145, the attitude of the imu's frame (x forward, "
        "y left, z up) in a world of which z is up (ENU, not NED), a quaternion x, y, z, w that turns the imu's frame "
        "into the world, and at rest +9.8 m/s^2 along up",
        contradiction_.c_str());
  }
  return found.has_value();
}

/// Shows tf's attitudes at the imu's stamps to their watch.
void UpDirection::watchTf() {
  for (const auto& imu : not_watched_) {
    const auto T_I_W = transforms_.find(imu->header.frame_id, gravity_frame_, imu->header.stamp);
    if (T_I_W) tf_watch_.add(*imu, T_I_W->linear().col(2));
  }
  not_watched_.clear();
}

void UpDirection::warnUnknown(const std_msgs::Header& camera, bool tf_knows_it) {
  if (warning_.due()) {
    ROS_WARN(
        "the direction of up is unknown at %.3f: tf %s \"%s\" (ros/gravity_frame) to \"%s\", and there is no Imu with "
        "an orientation, and a mounting in tf, within %.1f s. A level corridor (corridor/level) is UNKNOWN, and every "
        "range of scan and obstacle_distance is NaN. Publish the attitude, or set ros/gravity_frame to a fixed frame, "
        "z up, that tf has",
        camera.stamp.toSec(), tf_knows_it ? "is late from" : "does not connect", gravity_frame_.c_str(),
        camera.frame_id.c_str(), kNear_s);
  }
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
