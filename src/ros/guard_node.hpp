#pragma once

#include <geometry_msgs/Twist.h>
#include <ros/node_handle.h>
#include <sensor_msgs/Imu.h>

#include <mutex>
#include <string>
#include <vector>

#include "ros/guard.hpp"
#include "ros/heartbeat.hpp"
#include "ros/transforms.hpp"

namespace flight_corridor_ros {

/// Guard on topics: `cmd_vel_in`, `free_areas`, `corridor` and `imu` in, `cmd_vel` out at a steady rate of wall time.
class GuardNode {
 public:
  /// @throws std::invalid_argument naming every wrong parameter, or if `cmd_vel_in` and `cmd_vel` are one topic.
  GuardNode(const ros::NodeHandle& node, const ros::NodeHandle& private_node);

 private:
  template <typename Message>
  void listen(const std::string& topic);
  void take(const flight_corridor::FreeAreas& areas);
  void take(const flight_corridor::CorridorState& corridor);
  void take(const geometry_msgs::Twist& command);
  void take(const geometry_msgs::TwistStamped& command);
  void take(const sensor_msgs::Imu& imu);
  void lookAtTf();
  void publish();
  void warnOfOtherSenders() const;

  const GuardConfig config_;
  std::mutex mutex_;
  Guard guard_;
  Throttle warning_;
  ros::NodeHandle node_;
  Transforms transforms_;
  std::string camera_frame_;  // of free_areas
  ros::Publisher publisher_;
  std::vector<ros::Subscriber> subscribers_;
  Heartbeat senders_;    // asks the master, which may take its time
  Heartbeat heartbeat_;  // last: it calls publish()
};

}  // namespace flight_corridor_ros
