#include "tools/replayer.hpp"

#include <ros/console.h>

#include <cmath>

#include "ros/values.hpp"
#include "tools/command_line.hpp"

namespace flight_corridor::tools {
namespace {

namespace shell = flight_corridor_ros;

/// The reader hands out poses early instead.
shell::NodeConfig withoutWaiting(shell::NodeConfig config) {
  config.ros.tf_timeout_s = 0.0;
  return config;
}

/// @param numbers x y z yaw pitch roll, as static_transform_publisher turns: about z, then y, then x.
Eigen::Isometry3d mounting(const std::vector<double>& numbers) {
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

void addOptions(CLI::App& app, ReplayInput& input) {
  app.add_option("--bag", input.bag, "bag to read")->type_name("F.bag")->required();
  app.add_option("--config", input.config, "configuration of the node; else its defaults")->type_name("C.yaml");
  app.add_option("--set", input.overrides, "overrides one key of it, e.g. map/frame_id=odom")
      ->type_name("key=value")
      ->allow_extra_args(false);
  app.option_defaults()->group("Where the bag leaves it open");
  app.add_option("--left", input.topics.left,
                 "left image; topics that are not named are found by type and name,\nsee replay --list")
      ->type_name("TOPIC");
  app.add_option("--left-info", input.topics.left_info, "left CameraInfo")->type_name("TOPIC");
  app.add_option("--right", input.topics.right, "right image")->type_name("TOPIC");
  app.add_option("--right-info", input.topics.right_info, "right CameraInfo")->type_name("TOPIC");
  app.add_option("--range", input.topics.range, "LiDAR (sensor_msgs/Range), or none; optional unless named")
      ->type_name("TOPIC");
  app.add_option("--imu", input.topics.imu, "imu (sensor_msgs/Imu); optional unless named")->type_name("TOPIC");
  app.add_option("--odom", input.topics.odom, "odometry (nav_msgs/Odometry); optional unless named")
      ->type_name("TOPIC");
  CLI::Option* calib = app.add_option("--calib", input.reading.calibration_files,
                                      "calibration in place of CameraInfos; if each camera has a file:\nleft first")
                           ->type_name("FILE")
                           ->allow_extra_args(false);
  app.add_option("--calib-left", input.reading.cameras.left,
                 "left camera in a calibration of several, e.g. cam2; default: by\nits rostopic")
      ->type_name("NAME")
      ->needs(calib);
  app.add_option("--calib-right", input.reading.cameras.right, "right camera in it")->type_name("NAME")->needs(calib);
  CLI::Option* raw = app.add_flag_callback(
      "--raw", [&] { input.reading.images = ImageState::Raw; }, "the images are raw: rectify them");
  app.add_flag_callback(
         "--rectified", [&] { input.reading.images = ImageState::Rectified; },
         "the images are rectified, whatever their topic is called")
      ->excludes(raw);
  app.add_flag("--stamps", input.reading.by_stamps, "use the stamps as times of recording, for a converted bag");
  app.add_option_function<std::vector<double>>(
         "--lidar-at", [&](const std::vector<double>& numbers) { input.reading.T_F_L = mounting(numbers); },
         "pose of the LiDAR, in place of tf: from the left camera x forward,\ny left, z up [m], beam along its +x, "
         "angles as\nstatic_transform_publisher's [rad]")
      ->option_text("\"X Y Z YAW PITCH ROLL\"")
      ->expected(6)
      ->delimiter(' ')
      ->check(number());
  app.option_defaults()->group("Options");
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
  listener.on_odometry = [&](const nav_msgs::Odometry& odometry) { transforms_.add(odometry); };
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
        "node would refuse it as well. Synchronise the cameras' clock with the recorder's; if a conversion lost the "
        "times of recording, --stamps uses the stamps instead",
        pair.header.stamp.toSec(), std::abs(age_s), age_s < 0.0 ? "before" : "after", max_age_s);
  }
  return false;
}

}  // namespace flight_corridor::tools
