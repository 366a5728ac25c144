#pragma once

#include <functional>
#include <string>
#include <vector>

#include "ros/heartbeat.hpp"
#include "ros/inbox.hpp"
#include "ros/params.hpp"
#include "ros/processor.hpp"
#include "ros/transforms.hpp"
#include "tools/stereo_bag_reader.hpp"

namespace CLI {
class App;
}

namespace flight_corridor::tools {

/// The node's configuration from a YAML file ("": the defaults) and overrides "key=value".
/// @throws std::invalid_argument naming the faults of the file or its keys.
flight_corridor_ros::NodeConfig readConfig(const std::string& yaml_path, const std::vector<std::string>& overrides);

/// What is read: a bag, as what, with which configuration.
struct ReplayInput {
  std::string bag, config;
  std::vector<std::string> overrides;
  StereoTopics topics{"", "", "", "", "", "", ""};  ///< To be found where the command line does not name them.
  BagReading reading;
};

/// Adds the options that fill it: --bag, --config, --set, the topics, and what a bag does not hold.
void addOptions(CLI::App& app, ReplayInput& input);

/// The result of one pair.
struct Answer {
  const RecordedPair& messages;
  const Report& report;
  Pipeline* pipeline;  ///< The pipeline with the pair's products; null if the pair was refused.
};

/// The node's pipeline on a bag, without a master and without a clock: the same bag gives the same answers.
class Replayer {
 public:
  Replayer(const StereoBagReader& bag, const flight_corridor_ros::NodeConfig& config);

  /// Processes the whole bag, in the order of recording. The time of recording acts as the node's clock: a pair that is
  /// too old by then is refused, and a pose that comes too late is missing.
  /// @return the stamps of all messages that could form pairs.
  PairStamps run(const std::function<void(const Answer& answer)>& on_answer);

  /// The map after the newest pair; empty if no pair entered it.
  const octomap::OcTree& map() { return processor_.map(); }

 private:
  bool isFresh(const RecordedPair& pair);

  const StereoBagReader& bag_;
  const flight_corridor_ros::NodeConfig config_;
  flight_corridor_ros::Transforms transforms_;
  flight_corridor_ros::Inbox inbox_;
  flight_corridor_ros::Processor processor_;
  flight_corridor_ros::Throttle age_warning_;
};

}  // namespace flight_corridor::tools
