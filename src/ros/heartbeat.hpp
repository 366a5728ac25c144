#pragma once

#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>

#include <functional>

namespace flight_corridor_ros {

/// Calls back at a steady wall-clock rate from a thread of its own: even if processing hangs or /clock stands still.
class Heartbeat {
 public:
  Heartbeat(double period_s, const std::function<void()>& beat);

 private:
  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  ros::WallTimer timer_;
  ros::AsyncSpinner spinner_;
};

/// Lets a message through at most every few seconds of wall time (ROS_WARN_THROTTLE is mute until /clock ticks).
class Throttle {
 public:
  bool due();

 private:
  ros::WallTime last_;
};

}  // namespace flight_corridor_ros
