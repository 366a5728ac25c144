#include "tools/replayer.hpp"

#include <ros/console.h>

#include <cmath>

#include "ros/values.hpp"

namespace flight_corridor::tools {
namespace {

namespace shell = flight_corridor_ros;

/// The reader hands out poses early instead.
shell::NodeConfig withoutWaiting(shell::NodeConfig config) {
  config.ros.tf_timeout_s = 0.0;
  return config;
}

void showWarningsOnly() {
  if (ros::console::set_logger_level(ROSCONSOLE_DEFAULT_NAME, ros::console::levels::Warn)) {
    ros::console::notifyLoggerLevelsChanged();
  }
}

}  // namespace

shell::NodeConfig readConfig(const std::string& yaml_path, const std::vector<std::string>& overrides) {
  shell::Values values;
  if (!yaml_path.empty()) values = shell::readYaml(yaml_path);
  for (const std::string& key_and_value : overrides) shell::setParameter(values, key_and_value);
  return shell::makeConfig(values);
}

void declareTopics(CommandLine& options) {
  const StereoTopics topics;
  options.optional("left", "TOPIC", "left rectified image", topics.left)
      .optional("left-info", "TOPIC", "left CameraInfo", topics.left_info)
      .optional("right", "TOPIC", "right rectified image", topics.right)
      .optional("right-info", "TOPIC", "right CameraInfo", topics.right_info)
      .optional("range", "TOPIC", "LiDAR (sensor_msgs/Range); may be missing unless named", topics.range)
      .optional("imu", "TOPIC", "imu (sensor_msgs/Imu); may be missing unless named", topics.imu);
}

StereoTopics topicsFrom(const CommandLine& options) {
  return {options.text("left"),       options.text("left-info"), options.text("right"),
          options.text("right-info"), options.text("range"),     options.text("imu")};
}

Replayer::Replayer(const StereoBagReader& bag, const shell::NodeConfig& config)
    : bag_(bag), config_(config), processor_(withoutWaiting(config), transforms_, inbox_) {
  showWarningsOnly();
}

PairStamps Replayer::run(const std::function<void(const Answer& answer)>& on_answer) {
  StereoBagReader::Listener listener;
  listener.on_pair = [&](const RecordedPair& pair) {
    if (isFresh(pair)) {
      const Report& report = processor_.process(pair);
      on_answer({pair, report, processor_.products()});
    } else {
      on_answer({pair, shell::refusal(pair.header.stamp, kNoData), nullptr});
    }
  };
  listener.on_range = [&](const sensor_msgs::RangeConstPtr& range) { inbox_.put(range); };
  listener.on_imu = [&](const sensor_msgs::ImuConstPtr& imu) { inbox_.put(imu); };
  listener.on_transform = [&](const geometry_msgs::TransformStamped& transform, bool is_static) {
    transforms_.add(transform, is_static);
  };
  return bag_.play(config_.ros, listener);
}

/// As the node, of which the clock is the time of recording when the bag is played with --clock.
bool Replayer::isFresh(const RecordedPair& pair) {
  const double age_s = pair.recorded.toSec() - pair.header.stamp.toSec();
  const double max_age_s = config_.core.corridor.max_age_s;
  const bool has_stamp = !pair.header.stamp.isZero();  // or the processor says that it has none
  if (!has_stamp || std::abs(age_s) <= max_age_s) return true;
  if (age_warning_.due()) {
    ROS_WARN(
        "stereo pair of %.3f was recorded %.3f s %s its stamp, more than %.3f s (corridor/max_age_s): UNKNOWN, the "
        "node "
        "would refuse it as well. Synchronise the cameras' clock with the recorder's; a bag that was converted must "
        "keep the times of recording, or take the stamps for them",
        pair.header.stamp.toSec(), std::abs(age_s), age_s < 0.0 ? "before" : "after", max_age_s);
  }
  return false;
}

}  // namespace flight_corridor::tools
