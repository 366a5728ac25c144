#include "ros/guard_node.hpp"

#include <ros/console.h>

#include <stdexcept>

#include "ros/imu.hpp"
#include "ros/other_publishers.hpp"
#include "ros/up_direction.hpp"

namespace flight_corridor_ros {

namespace {

constexpr double kSendersPeriod_s = 5.0;

/// The node, unless it would hear itself.
const ros::NodeHandle& withoutLoop(const ros::NodeHandle& node) {
  const std::string topic = node.resolveName("cmd_vel");
  if (node.resolveName("cmd_vel_in") != topic) return node;
  throw std::invalid_argument("cmd_vel_in and cmd_vel are one topic, " + topic +
                              ": the guard would hear its own commands, and keep the last one alive for ever. Remap "
                              "one of them (corridor_guard.launch: cmd_vel_in, cmd_vel)");
}

GuardTime timeNow() { return {ros::Time::now(), ros::SteadyTime::now().toSec()}; }

}  // namespace

GuardNode::GuardNode(const ros::NodeHandle& node, const ros::NodeHandle& private_node)
    : config_(makeGuardConfig(readParameters(private_node))),
      guard_(config_),
      node_(withoutLoop(node)),
      transforms_(node_),
      publisher_(config_.stamped ? node_.advertise<geometry_msgs::TwistStamped>("cmd_vel", 1)
                                 : node_.advertise<geometry_msgs::Twist>("cmd_vel", 1)),
      senders_(kSendersPeriod_s, [this] { warnOfOtherSenders(); }),
      heartbeat_(1.0 / config_.rate_hz, [this] { publish(); }) {
  listen<flight_corridor::FreeAreas>("free_areas");
  listen<flight_corridor::CorridorState>("corridor");
  listen<sensor_msgs::Imu>("imu");
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
  camera_frame_ = areas.header.frame_id;
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

/// Its orientation, if it has a valid one, and how fast it turns about the vertical by its gyroscopes.
void GuardNode::take(const sensor_msgs::Imu& imu) {
  if (!toUp(imu)) return;
  const auto& q = imu.orientation;
  const std::lock_guard<std::mutex> lock(mutex_);
  const Eigen::Quaterniond R_W_I = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized();
  guard_.seeImu(imu.header.stamp, R_W_I);
  if (const auto rate_I = toRate(imu)) guard_.seeImuRate(imu.header.stamp, (R_W_I * *rate_I).z());
}

void GuardNode::lookAtTf() {
  if (camera_frame_.empty()) return;
  const auto stamp = transforms_.newestStamp(config_.gravity_frame, camera_frame_);
  if (!stamp) return;
  const auto T_W_C = transforms_.find(config_.gravity_frame, camera_frame_, *stamp);
  if (T_W_C) guard_.seeTf(*stamp, Eigen::Quaterniond(T_W_C->linear()));
}

/// What others send to the autopilot is not limited.
void GuardNode::warnOfOtherSenders() const {
  const std::string topic = publisher_.getTopic();
  std::string names;
  for (const std::string& name : otherPublishers(topic)) names += (names.empty() ? "" : ", ") + name;
  if (names.empty()) return;
  ROS_WARN("%s is also published by %s: these commands pass by the guard. Stop them, or remap them to its cmd_vel_in",
           topic.c_str(), names.c_str());
}

void GuardNode::publish() {
  const std::lock_guard<std::mutex> lock(mutex_);
  lookAtTf();
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
