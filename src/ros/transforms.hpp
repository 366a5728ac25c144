#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <ros/node_handle.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>

namespace flight_corridor_ros {

/// A frame's name as tf2 and all who use it take it: tf's first generation began names with a slash, and drivers and
/// old bags still do.
std::string withoutSlash(const std::string& frame);

/// Poses from tf.
class Transforms {
 public:
  /// Listens to /tf and /tf_static.
  explicit Transforms(const ros::NodeHandle& node) { listener_.emplace(buffer_, node); }
  /// Listens to nobody: knows what add() tells, and forgets nothing that a recording could hold.
  Transforms() : buffer_(ros::Duration(1e8)) {}

  void add(const geometry_msgs::TransformStamped& transform, bool is_static) {
    buffer_.setTransform(transform, "recording", is_static);
  }

  /// T_target_source at a stamp (ros::Time(0): the newest).
  /// @param timeout_s how long to wait for it [s of wall time: a stopped /clock must not hold the caller].
  /// @return nullopt when tf does not know it by then.
  std::optional<Eigen::Isometry3d> find(std::string target, std::string source, const ros::Time& stamp,
                                        double timeout_s = 0.0) const;

 private:
  tf2_ros::Buffer buffer_;
  std::optional<tf2_ros::TransformListener> listener_;
};

}  // namespace flight_corridor_ros
