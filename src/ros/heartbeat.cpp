#include "ros/heartbeat.hpp"

namespace flight_corridor_ros {

namespace {

const ros::WallDuration kThrottlePeriod(5.0);

}  // namespace

Heartbeat::Heartbeat(double period_s, const std::function<void()>& beat) : spinner_(1, &queue_) {
  node_.setCallbackQueue(&queue_);
  timer_ = node_.createWallTimer(ros::WallDuration(period_s), [beat](const ros::WallTimerEvent&) { beat(); });
  spinner_.start();
}

bool Throttle::due() {
  const ros::WallTime now = ros::WallTime::now();
  if (now - last_ < kThrottlePeriod) return false;
  last_ = now;
  return true;
}

}  // namespace flight_corridor_ros
