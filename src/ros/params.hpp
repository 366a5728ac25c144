#pragma once

#include <string>
#include <vector>

#include "flight_corridor/config.hpp"
#include "ros/values.hpp"

namespace flight_corridor_ros {

/// Section `ros/` of doc/parameters.md: parameters of the shell only.
struct RosConfig {
  bool approximate_sync = false;
  double sync_slop_s = 0.01;
  int sync_queue = 10;
  std::string gravity_frame = "odom";
  double watchdog_s = 0.5;
  double tf_timeout_s = 0.05;
  std::string image_transport = "raw";
  double scale = 1.0;
};

/// The whole configuration: the core's sections and the shell's.
struct NodeConfig {
  flight_corridor::Config core;
  RosConfig ros;
  std::string mask;  ///< `stereo/mask`: image file, see readOwnParts(); "": nothing of the UAV is in view.
};

/// The core's table and the shell's rows.
std::vector<flight_corridor::ParameterTable> tablesOf(NodeConfig& config);

/// Configuration with these values, defaults elsewhere. An int is accepted where a double is expected, not the reverse.
/// @throws std::invalid_argument listing every unknown key, wrong type and broken rule, with key, rule and value.
NodeConfig makeConfig(const Values& values);

/// Every parameter of a configuration.
Values toValues(const NodeConfig& config);

}  // namespace flight_corridor_ros
