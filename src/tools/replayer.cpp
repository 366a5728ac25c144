#include "tools/replayer.hpp"

#include <ros/console.h>

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "ros/values.hpp"

namespace flight_corridor::tools {
namespace {

namespace shell = flight_corridor_ros;

/// The reader hands out poses early instead.
shell::NodeConfig withoutWaiting(shell::NodeConfig config) {
  config.ros.tf_timeout_s = 0.0;
  return config;
}

/// "x y z yaw pitch roll", as static_transform_publisher turns: about z, then y, then x.
Eigen::Isometry3d parseMounting(const std::string& text) {
  std::istringstream words(text);
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    char* end = nullptr;
    numbers.push_back(std::strtod(word.c_str(), &end));
    if (*end != '\0' || !std::isfinite(numbers.back()))
      throw UsageError("--lidar-at: '" + word + "' is no finite number");
  }
  if (numbers.size() != 6) {
    throw UsageError("--lidar-at: wanted are six numbers, \"X Y Z YAW PITCH ROLL\" (" + std::to_string(numbers.size()) +
                     ")");
  }
  return Eigen::Translation3d(numbers[0], numbers[1], numbers[2]) *
         Eigen::AngleAxisd(numbers[3], Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(numbers[4], Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(numbers[5], Eigen::Vector3d::UnitX());
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

void declareBag(CommandLine& options) {
  options.optional("left", "TOPIC", "left image; where it is not named, topics are found by type and name, see --list")
      .optional("left-info", "TOPIC", "left CameraInfo")
      .optional("right", "TOPIC", "right image")
      .optional("right-info", "TOPIC", "right CameraInfo")
      .optional("range", "TOPIC", "LiDAR (sensor_msgs/Range), or none; may be missing unless named")
      .optional("imu", "TOPIC", "imu (sensor_msgs/Imu); may be missing unless named")
      .repeatable("calib", "FILE", "calibration in place of CameraInfos; where each camera has a file: left first")
      .optional("calib-left", "NAME", "left camera in a calibration of several, e.g. cam2; default: by its rostopic")
      .optional("calib-right", "NAME", "right camera in it")
      .flag("raw", "the images are raw: rectify them")
      .flag("rectified", "the images are rectified, whatever their topic is called")
      .flag("stamps", "the stamps stand for the times of recording: for a bag that was converted")
      .optional(
          "lidar-at", "\"X Y Z YAW PITCH ROLL\"",
          "where the LiDAR sits, in place of tf: from the left camera x forward, y left, z up [m], beam along its "
          "+x, angles as static_transform_publisher's [rad]");
}

StereoTopics topicsFrom(const CommandLine& options) {
  return {options.text("left"),       options.text("left-info"), options.text("right"),
          options.text("right-info"), options.text("range"),     options.text("imu")};
}

BagReading readingFrom(const CommandLine& options) {
  BagReading reading;
  reading.calibration_files = options.all("calib");
  reading.cameras = {options.text("calib-left"), options.text("calib-right")};
  for (const char* name : {"calib-left", "calib-right"}) {
    if (options.given(name) && !options.given("calib"))
      throw UsageError("--" + std::string(name) + " needs --calib, the file");
  }
  if (options.given("raw") && options.given("rectified"))
    throw UsageError("--raw and --rectified contradict each other");
  if (options.given("raw")) reading.images = ImageState::Raw;
  if (options.given("rectified")) reading.images = ImageState::Rectified;
  reading.by_stamps = options.given("stamps");
  if (options.given("lidar-at")) reading.T_F_L = parseMounting(options.text("lidar-at"));
  return reading;
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
        "node would refuse it as well. Synchronise the cameras' clock with the recorder's; where a conversion lost the "
        "times of recording, --stamps takes the stamps for them",
        pair.header.stamp.toSec(), std::abs(age_s), age_s < 0.0 ? "before" : "after", max_age_s);
  }
  return false;
}

}  // namespace flight_corridor::tools
