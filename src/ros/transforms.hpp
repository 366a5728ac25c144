#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/buffer.h>

#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <string>

#include "ros/heartbeat.hpp"

namespace flight_corridor_ros {

/// A frame's name as in tf2, without the leading slash of the first tf, which drivers and old bags still use.
std::string withoutSlash(const std::string& frame);

/// Whether the libraries can represent a stamp: near the end of ros::Time (2106) its arithmetic throws in their
/// threads, which ends the process.
inline bool isPossible(const ros::Time& stamp) { return stamp.sec < 4000000000u; }

/// Whether it is of norm 1, but for the rounding of numbers typed by hand.
inline bool isUnit(const Eigen::Quaterniond& rotation) { return std::abs(rotation.norm() - 1.0) <= 0.01; }

/// Poses from tf.
class Transforms {
 public:
  /// Listens to /tf and /tf_static in a thread of its own. (In tf2_ros's listener an invalid stamp can end the
  /// process.)
  explicit Transforms(const ros::NodeHandle& node);
  /// Subscribes to nothing: knows only the transforms of add(), and forgets none within a recording.
  Transforms() : buffer_(ros::Duration(1e8)) {}

  /// Listens to odom, too, in the same thread.
  void listenToOdometry(const ros::NodeHandle& node);

  /// Transforms that tf2 refuses are left out.
  void add(const geometry_msgs::TransformStamped& transform, bool is_static);

  /// Motion of a body that tf need not know in a fixed frame: kOdometryFrame stands still, whatever fixed frame the
  /// message names. A message without stamp, body or pose is left out, with a throttled warning.
  void add(const nav_msgs::Odometry& odometry);

  /// A name that no frame of tf has.
  static constexpr char kOdometryFrame[] = "nav_msgs/Odometry";

  /// A message of a topic, which came now.
  void receive(const tf2_msgs::TFMessage& message, bool is_static);
  void receive(const nav_msgs::Odometry& odometry);

  /// T_target_source at a stamp (ros::Time(0): the newest).
  /// @param timeout_s how long to wait for it [s of wall time: a stopped /clock must not hold the caller].
  /// @param tolerance_s where it is not known by then, so far from the stamp the newest counts [s].
  /// @return nullopt when tf knows neither.
  std::optional<Eigen::Isometry3d> find(std::string target, std::string source, const ros::Time& stamp,
                                        double timeout_s = 0.0, double tolerance_s = 0.0) const;

  /// Whether odometry came.
  bool hasOdometry() const { return buffer_._frameExists(kOdometryFrame); }

  /// Stamp of the newest T_target_source.  @return nullopt when tf knows none, or one for all times.
  std::optional<ros::Time> newestStamp(const std::string& target, const std::string& source) const;

 private:
  void forgetWhenTimeJumpsBack();

  tf2_ros::Buffer buffer_;
  ros::Time heard_;  // time of the newest message
  Throttle warning_, odometry_warning_;
  ros::CallbackQueue queue_;
  ros::Subscriber moving_, static_, odometry_;
  std::optional<ros::AsyncSpinner> spinner_;
};

}  // namespace flight_corridor_ros
