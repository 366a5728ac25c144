#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/Range.h>

#include <atomic>
#include <mutex>
#include <string>
#include <thread>

#include "ros/diagnostics.hpp"
#include "ros/direction_publishers.hpp"
#include "ros/goal_direction.hpp"
#include "ros/heartbeat.hpp"
#include "ros/inbox.hpp"
#include "ros/params.hpp"
#include "ros/processor.hpp"
#include "ros/publishers.hpp"
#include "ros/reconfigure.hpp"
#include "ros/services.hpp"
#include "ros/stereo_subscriber.hpp"
#include "ros/transforms.hpp"

namespace flight_corridor_ros {

/// The pipeline on ROS topics and services. Threads: callbacks fill the inbox, one worker owns the pipeline, queries
/// wait for it, a watchdog publishes UNKNOWN while no verdict comes, diagnostics are published once a second, tf2
/// listens.
class Node {
 public:
  /// @throws std::invalid_argument listing every fault of the parameters.
  Node(const ros::NodeHandle& node, const ros::NodeHandle& private_node);
  ~Node();
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

 private:
  void receive(const StereoMessages& pair);
  void work();
  void answer(const StereoMessages& pair);
  void publish(const std_msgs::Header& header, const flight_corridor::Report& report);
  void publishRefusal(const std_msgs::Header& header, const flight_corridor::Report& report);
  bool isFresh(const ros::Time& stamp);
  double silence() const;
  void guard();
  void configure(const NodeConfig& config);

  const NodeConfig config_;                     // at the start
  std::atomic<double> max_age_s_, watchdog_s_;  // effective
  Publishers publishers_;
  Transforms transforms_;
  GoalDirection goal_;
  DirectionPublishers directions_;
  Inbox inbox_;
  Processor processor_;
  Diagnostics diagnostics_;
  Throttle age_warning_, silence_warning_;

  std::mutex camera_frame_mutex_;
  std::string camera_frame_;  // for the watchdog
  std::atomic<double> answered_s_;

  Services services_;
  Reconfigure reconfigure_;
  StereoSubscriber stereo_;
  ros::Subscriber range_, imu_, goal_direction_;
  Heartbeat watchdog_;
  std::thread worker_;  // last: nothing after it may throw
};

}  // namespace flight_corridor_ros
