#pragma once

#include <string>

#include "flight_corridor/config.hpp"
#include "ros/values.hpp"

namespace flight_corridor_ros {

/// Section `ros/`: parameters of the shell only.
struct RosConfig {
  bool approximate_sync = false;        ///< Pair images whose stamps differ; false: equal stamps only.
  double sync_slop_s = 0.01;            ///< Largest difference within a pair when approximate_sync.
  int sync_queue = 10;                  ///< Images and CameraInfos that wait for their partners, per topic.
  std::string gravity_frame = "odom";   ///< Fixed frame of tf, z up: says where up is.
  double watchdog_s = 0.5;              ///< After this long without a verdict, UNKNOWN is published.
  double tf_timeout_s = 0.05;           ///< Wait for a pose at an image's stamp.
  std::string image_transport = "raw";  ///< Transport of the incoming images.
  double scale = 1.0;                   ///< Of the images that are processed: 1, 0.5, 0.25 or 0.125.
};
flight_corridor::Violations check(const RosConfig& config);

/// The whole configuration: the core's sections and the shell's.
struct NodeConfig {
  flight_corridor::Config core;
  RosConfig ros;
  std::string mask;  ///< `stereo/mask`: image file, see readOwnParts(); "": nothing of the UAV is in view.
};

/// Configuration with these values, defaults elsewhere. An int is accepted where a double is expected, not the reverse.
/// @throws std::invalid_argument listing every unknown key, wrong type and broken rule, with key, rule and value.
NodeConfig makeConfig(const Values& values);

/// Every parameter of a configuration.
Values toValues(const NodeConfig& config);

}  // namespace flight_corridor_ros
