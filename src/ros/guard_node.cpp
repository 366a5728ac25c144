#include "ros/guard_node.hpp"

#include <ros/console.h>

namespace flight_corridor_ros {

namespace {

GuardTime timeNow() { return {ros::Time::now(), ros::SteadyTime::now().toSec()}; }

}  // namespace

GuardNode::GuardNode(const ros::NodeHandle& node, const ros::NodeHandle& private_node)
    : config_(makeGuardConfig(readParameters(private_node))),
      guard_(config_),
      node_(node),
      publisher_(config_.stamped ? node_.advertise<geometry_msgs::TwistStamped>("cmd_vel", 1)
                                 : node_.advertise<geometry_msgs::Twist>("cmd_vel", 1)),
      heartbeat_(1.0 / config_.rate_hz, [this] { publish(); }) {
  listen<flight_corridor::FreeAreas>("free_areas");
  listen<flight_corridor::CorridorState>("corridor");
  if (config_.stamped) {
    listen<geometry_msgs::TwistStamped>("cmd_vel_in");
  } else {
    listen<geometry_msgs::Twist>("cmd_vel_in");
  }
}

template <typename Message>
void GuardNode::listen(const std::string& topic) {
  subscribers_.push_back(
      node_.subscribe<Message>(topic, 1, [this](const boost::shared_ptr<const Message>& message) { take(*message); }));
}

void GuardNode::take(const flight_corridor::FreeAreas& areas) {
  const std::lock_guard<std::mutex> lock(mutex_);
  guard_.see(areas, timeNow());
}

void GuardNode::take(const flight_corridor::CorridorState& corridor) {
  const std::lock_guard<std::mutex> lock(mutex_);
  guard_.see(corridor, timeNow());
}

void GuardNode::take(const geometry_msgs::Twist& command) {
  geometry_msgs::TwistStamped stamped;
  stamped.twist = command;
  take(stamped);
}

void GuardNode::take(const geometry_msgs::TwistStamped& command) {
  const std::lock_guard<std::mutex> lock(mutex_);
  guard_.command(command, timeNow());
}

void GuardNode::publish() {
  const std::lock_guard<std::mutex> lock(mutex_);
  const GuardTime time = timeNow();
  const GuardedCommand command = guard_.limited(time);
  if (!command.why.empty() && warning_.due()) ROS_WARN("%s", command.why.c_str());
  if (!config_.stamped) return publisher_.publish(command.twist);
  geometry_msgs::TwistStamped stamped;
  stamped.header.stamp = time.now;
  stamped.header.frame_id = config_.frame_id;
  stamped.twist = command.twist;
  publisher_.publish(stamped);
}

}  // namespace flight_corridor_ros
