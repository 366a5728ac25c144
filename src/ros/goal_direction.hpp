#pragma once

#include <geometry_msgs/Vector3Stamped.h>
#include <ros/time.h>
#include <std_msgs/Header.h>

#include <Eigen/Core>
#include <mutex>
#include <optional>
#include <string>

#include "ros/heartbeat.hpp"
#include "ros/transforms.hpp"

namespace flight_corridor_ros {

/// The direction in which the pilot or the planner wants to go: the newest message, until the next one. It is a
/// direction of its frame: in a fixed frame it stays when the UAV turns. Any thread.
class GoalDirection {
 public:
  explicit GoalDirection(const Transforms& transforms) : transforms_(transforms) {}

  /// Takes a message, or warns of it and keeps the last one: no frame, a vector of zero length or not finite, or a
  /// stamp (other than 0) more than a second from now.
  void put(const geometry_msgs::Vector3Stamped& message, const ros::Time& now);

  /// Unit vector in the camera's frame at its stamp, by tf's newest pose, up to a second from it, where that of then is
  /// not there yet.
  /// @return nullopt: nobody said anything, or tf does not know the frame (warns).
  std::optional<Eigen::Vector3d> find(const std_msgs::Header& camera);

 private:
  void refuse(const std::string& why);

  const Transforms& transforms_;
  std::mutex mutex_;
  std::string frame_;  // "": no goal was given
  Eigen::Vector3d direction_;
  Throttle warning_, frame_warning_;
};

}  // namespace flight_corridor_ros
