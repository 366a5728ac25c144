#include "ros/transforms.hpp"

#include <ros/console.h>
#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "flight_corridor/range/pending_readings.hpp"

namespace flight_corridor_ros {

namespace {

constexpr std::uint32_t kQueue = 1000;  // messages; many nodes send poses at 100 Hz and more

}  // namespace

std::string withoutSlash(const std::string& frame) {
  const std::size_t first = frame.find_first_not_of('/');
  return first == std::string::npos ? "" : frame.substr(first);
}

Transforms::Transforms(const ros::NodeHandle& node) {
  ros::NodeHandle listener(node);
  listener.setCallbackQueue(&queue_);
  const auto subscribe = [&](const std::string& topic, bool is_static) {
    return listener.subscribe<tf2_msgs::TFMessage>(
        topic, kQueue, [this, is_static](const tf2_msgs::TFMessageConstPtr& message) { receive(*message, is_static); });
  };
  moving_ = subscribe("/tf", false);
  static_ = subscribe("/tf_static", true);
  spinner_.emplace(1, &queue_);
  spinner_->start();
}

void Transforms::listenToOdometry(const ros::NodeHandle& node) {
  ros::NodeHandle listener(node);
  listener.setCallbackQueue(&queue_);
  odometry_ = listener.subscribe<nav_msgs::Odometry>(
      "odom", kQueue, [this](const nav_msgs::OdometryConstPtr& message) { receive(*message); });
}

/// If the clock was set back by more than synchronised clocks differ, poses of the other time are useless.
void Transforms::forgetWhenTimeJumpsBack() {
  const ros::Time now = ros::Time::now();
  if ((heard_ - now).toSec() > flight_corridor::kLongestDelay_s) {
    ROS_WARN("time jumped back: the poses from tf are forgotten");
    buffer_.clear();
    heard_ = now;
  }
  heard_ = std::max(heard_, now);
}

void Transforms::receive(const tf2_msgs::TFMessage& message, bool is_static) {
  forgetWhenTimeJumpsBack();
  for (const auto& transform : message.transforms) add(transform, is_static);
}

void Transforms::add(const geometry_msgs::TransformStamped& transform, bool is_static) {
  if (isPossible(transform.header.stamp)) {
    buffer_.setTransform(transform, "flight_corridor", is_static);
  } else if (warning_.due()) {
    ROS_WARN("tf of \"%s\" in \"%s\" is refused: its stamp, %.0f s, is impossible", transform.child_frame_id.c_str(),
             transform.header.frame_id.c_str(), transform.header.stamp.toSec());
  }
}

void Transforms::receive(const nav_msgs::Odometry& odometry) {
  forgetWhenTimeJumpsBack();
  add(odometry);
}

/// In tf the body may have another parent already, so the fixed frame becomes a child of the body.
void Transforms::add(const nav_msgs::Odometry& odometry) {
  const std::string body = withoutSlash(odometry.child_frame_id);
  const auto& q = odometry.pose.pose.orientation;
  const auto& p = odometry.pose.pose.position;
  const Eigen::Quaterniond turn(q.w, q.x, q.y, q.z);
  const Eigen::Vector3d at(p.x, p.y, p.z);
  const bool is_pose = at.allFinite() && isUnit(turn);  // not of NaN
  if (body.empty() || !is_pose || odometry.header.stamp.isZero()) {
    if (odometry_warning_.due()) {
      ROS_WARN(
          "odometry of \"%s\" is not used: it needs a stamp, a child_frame_id that tf connects with the camera, a "
          "finite position and a unit quaternion (norm %g)",
          body.c_str(), turn.norm());
    }
    return;
  }
  const Eigen::Isometry3d T_W_B = Eigen::Translation3d(at) * turn.normalized();
  geometry_msgs::TransformStamped fixed = tf2::eigenToTransform(T_W_B.inverse());
  fixed.header.stamp = odometry.header.stamp;
  fixed.header.frame_id = body;
  fixed.child_frame_id = kOdometryFrame;
  add(fixed, false);
}

std::optional<Eigen::Isometry3d> Transforms::find(std::string target, std::string source, const ros::Time& stamp,
                                                  double timeout_s, double tolerance_s) const {
  target = withoutSlash(target);
  source = withoutSlash(source);
  if (target.empty() || source.empty() || !isPossible(stamp)) return std::nullopt;
  if (target == source) return Eigen::Isometry3d::Identity();  // also where tf has never heard of it
  const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(timeout_s);
  const ros::WallDuration pause(0.001);
  try {
    while (!buffer_.canTransform(target, source, stamp) && ros::WallTime::now() < deadline) pause.sleep();
    const bool is_late = tolerance_s > 0.0 && !buffer_.canTransform(target, source, stamp);
    const auto found = buffer_.lookupTransform(target, source, is_late ? ros::Time(0) : stamp);
    if (is_late && !(std::abs((found.header.stamp - stamp).toSec()) <= tolerance_s)) return std::nullopt;
    const geometry_msgs::Transform& pose = found.transform;
    const Eigen::Translation3d position(pose.translation.x, pose.translation.y, pose.translation.z);
    const auto& q = pose.rotation;
    return position *
           Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized();  // tf takes squared norms that are off by 1 %
  } catch (const std::runtime_error&) {  // tf2's, or ros::Duration's: of a pose more than 68 years from the stamp
    return std::nullopt;
  }
}

std::optional<ros::Time> Transforms::newestStamp(const std::string& target, const std::string& source) const {
  try {
    const auto found = buffer_.lookupTransform(withoutSlash(target), withoutSlash(source), ros::Time(0));
    if (found.header.stamp.isZero()) return std::nullopt;
    return found.header.stamp;
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

}  // namespace flight_corridor_ros
