#pragma once

#include <functional>
#include <string>
#include <vector>

#include "ros/inbox.hpp"
#include "ros/params.hpp"
#include "ros/processor.hpp"
#include "tools/command_line.hpp"
#include "tools/stereo_bag.hpp"

namespace flight_corridor::tools {

/// The node's configuration from a YAML file ("": the defaults) and overrides "key=value".
/// @throws std::invalid_argument naming what is wrong with the file or its keys.
flight_corridor_ros::NodeConfig readConfig(const std::string& yaml_path, const std::vector<std::string>& overrides);

/// Declares --left, --left-info, --right, --right-info, --range and --imu.
void declareTopics(CommandLine& options);
StereoTopics topicsFrom(const CommandLine& options);

/// What became of one pair.
struct Answer {
  const StereoMessages& messages;
  const Report& report;
  Pipeline* pipeline;  ///< Holds the pair's products; null when the pair was refused and has none.
};

/// The node's pipeline on a bag, without a master and without a clock: the same bag gives the same answers.
class Replayer {
 public:
  Replayer(const StereoBagReader& bag, const flight_corridor_ros::NodeConfig& config);

  /// Processes the whole bag, in the order of recording.
  void run(const std::function<void(const Answer& answer)>& on_answer);

  /// What the newest pair left of the map; empty when none entered it.
  const octomap::OcTree& map() { return processor_.map(); }

 private:
  const StereoBagReader& bag_;
  flight_corridor_ros::NodeConfig config_;
  flight_corridor_ros::Inbox inbox_;
  flight_corridor_ros::Processor processor_;
};

}  // namespace flight_corridor::tools
