#include "tools/replayer.hpp"

#include <ros/console.h>

#include "ros/values.hpp"

namespace flight_corridor::tools {
namespace {

namespace shell = flight_corridor_ros;

/// A recording's poses are all there from the start: nothing to wait for.
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
    : bag_(bag), config_(withoutWaiting(config)), inbox_(config.ros), processor_(config_, bag.transforms(), inbox_) {
  showWarningsOnly();
}

void Replayer::run(const std::function<void(const Answer& answer)>& on_answer) {
  bag_.play(config_.ros, {[&](const StereoMessages& pair) {
                            const Report& report = processor_.process(pair);
                            on_answer({pair, report, processor_.products()});
                          },
                          [&](const sensor_msgs::RangeConstPtr& range) { inbox_.put(range); },
                          [&](const sensor_msgs::ImuConstPtr& imu) { inbox_.put(imu); }});
}

}  // namespace flight_corridor::tools
