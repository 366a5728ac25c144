#include "ros/node.hpp"

#include <ros/console.h>

#include <cmath>
#include <exception>
#include <string>

#include "ros/stamp_age.hpp"

namespace flight_corridor_ros {

namespace {

using flight_corridor::Report;

constexpr double kWatchdogPeriod_s = 0.1;
constexpr std::uint32_t kReadingQueue = 2000;  // readings while callbacks wait: 2 s at 1 kHz

/// By a steady clock.
double steadySeconds() { return ros::SteadyTime::now().toSec(); }

std::string ageRemedy(double age_s) {
  if (ros::Time::isSimTime()) return "use_sim_time is set: play the bag with --clock";
  return (age_s < 0.0 ? "" : "for a bag set use_sim_time and play it with --clock; for cameras ") + clockRemedy(age_s);
}

}  // namespace

Node::Node(const ros::NodeHandle& node, const ros::NodeHandle& private_node)
    : config_(makeConfig(readParameters(private_node))),
      max_age_s_(config_.core.corridor.max_age_s),
      watchdog_s_(config_.ros.watchdog_s),
      publishers_(private_node, config_.core),
      transforms_(node),
      goal_(transforms_),
      directions_(private_node, config_.core, goal_),
      processor_(config_, transforms_, inbox_),
      diagnostics_(node, private_node),
      answered_s_(steadySeconds()),
      services_(private_node, transforms_, inbox_, processor_,
                [this](const ros::Time& stamp) { return silence() <= watchdog_s_ && isFresh(stamp); }),
      reconfigure_(private_node, config_, inbox_, [this](const NodeConfig& config) { configure(config); }),
      stereo_(node, config_.ros, [this](const StereoMessages& pair) { receive(pair); }),
      range_(ros::NodeHandle(node).subscribe<sensor_msgs::Range>(
          "range", kReadingQueue, [this](const sensor_msgs::RangeConstPtr& range) { inbox_.put(range); })),
      imu_(ros::NodeHandle(node).subscribe<sensor_msgs::Imu>(
          "imu", kReadingQueue, [this](const sensor_msgs::ImuConstPtr& imu) { inbox_.put(imu); })),
      goal_direction_(ros::NodeHandle(node).subscribe<geometry_msgs::Vector3Stamped>(
          "goal_direction", 1,
          [this](const geometry_msgs::Vector3StampedConstPtr& goal) { goal_.put(*goal, ros::Time::now()); })),
      watchdog_(kWatchdogPeriod_s, [this] { guard(); }),
      worker_([this] { work(); }) {
  transforms_.listenToOdometry(node);
  if (config_.core.fusion.acceleration_sigma_mps2 == 0.0) {
    ROS_WARN(
        "fusion/acceleration_sigma_mps2 is 0: the filter's gain falls as 1/k and it stops following the range. "
        "Not for flight");
  }
}

Node::~Node() {
  inbox_.close();
  worker_.join();
}

/// Applies the parameters that may change in flight, in the worker's thread.
void Node::configure(const NodeConfig& config) {
  processor_.setCorridor(config.core.corridor);  // may refuse
  publishers_.setCorridor(config.core.corridor);
  directions_.setCorridor(config.core.corridor);
  max_age_s_ = config.core.corridor.max_age_s;
  watchdog_s_ = config.ros.watchdog_s;
}

void Node::receive(const StereoMessages& pair) {
  diagnostics_.countPair();
  inbox_.put(pair);
}

void Node::work() {
  while (const auto pair = inbox_.take()) {
    try {
      answer(*pair);
    } catch (const std::exception& error) {  // of a library; the watchdog speaks instead
      ROS_ERROR("no verdict: %s", error.what());
    }
  }
}

void Node::answer(const StereoMessages& pair) {
  const std_msgs::Header& header = pair.header;
  {
    const std::lock_guard<std::mutex> lock(camera_frame_mutex_);
    camera_frame_ = header.frame_id;
  }
  const auto refuseOld = [&] {
    publish(header, refusal(header.stamp, flight_corridor::kNoData));
    publishRefusal(header, refusal(header.stamp, flight_corridor::kNoData));
  };
  if (!isFresh(header.stamp)) return refuseOld();
  const Report& report = processor_.process(pair);
  if (!isFresh(header.stamp)) return refuseOld();
  publish(header, report);
  if (auto* pipeline = processor_.products()) {
    publishers_.publishProducts(*processor_.leftInfo(), header, processor_.left(), *pipeline, report,
                                processor_.lidar());
    directions_.publish(header, processor_.left(), *pipeline, [this] { return processor_.level(); });
  } else {
    publishRefusal(header, report);
  }
}

void Node::publish(const std_msgs::Header& header, const Report& report) {
  publishers_.publishVerdict(header, report);
  answered_s_ = steadySeconds();
  diagnostics_.record(report, processor_.counters(), processor_.device(), processor_.attitudeFault(),
                      ros::Time::now().toSec() - header.stamp.toSec());
}

/// Publishes on the other topics that a pair was refused or is missing.
void Node::publishRefusal(const std_msgs::Header& header, const Report& report) {
  publishers_.removeBox(header);
  directions_.publishRefusal(header, report.verdict.reasons);
}

/// Stamps from the future are not fresh either: with differing clocks the age is unknown.
bool Node::isFresh(const ros::Time& stamp) {
  const double age_s = ros::Time::now().toSec() - stamp.toSec();
  const double max_age_s = max_age_s_;
  if (std::abs(age_s) <= max_age_s) return true;
  if (age_warning_.due()) {
    ROS_WARN("stereo pair is %s, outside +-%.3f s (corridor/max_age_s): UNKNOWN. To do: %s", describeAge(age_s).c_str(),
             max_age_s, ageRemedy(age_s).c_str());
  }
  return false;
}

/// Time since the last verdict: a stopped /clock makes nothing old [s].
double Node::silence() const { return steadySeconds() - answered_s_; }

void Node::guard() {
  const double silent_s = silence();
  if (silent_s <= watchdog_s_) return;
  std_msgs::Header header;
  header.stamp = ros::Time::now();
  {
    const std::lock_guard<std::mutex> lock(camera_frame_mutex_);
    header.frame_id = camera_frame_;
  }
  const Report report = refusal(header.stamp, flight_corridor::kNoData);
  publishers_.publishVerdict(header, report);
  publishRefusal(header, report);
  if (silence_warning_.due()) {
    ROS_WARN("no verdict on a stereo pair for %.1f s: UNKNOWN. %s", silent_s, stereo_.explainSilence(silent_s).c_str());
  }
}

}  // namespace flight_corridor_ros
