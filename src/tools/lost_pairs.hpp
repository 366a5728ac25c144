#pragma once

#include <ros/time.h>

#include <array>
#include <string>
#include <vector>

#include "ros/params.hpp"

namespace flight_corridor::tools {

/// The stamps of one topic of a stereo pair, in the order of recording.
struct TopicStamps {
  std::string topic;
  std::vector<ros::Time> stamps;
};

/// Left image, its CameraInfo, right image, its CameraInfo.
using PairStamps = std::array<TopicStamps, 4>;

/// Why left images found no partners: how many did, the faults of each topic, and a remedy.
/// @param pairs number of left images that found theirs.
/// @return "" when all did.
std::string describeLostPairs(std::size_t pairs, const PairStamps& heard,
                              const flight_corridor_ros::RosConfig& pairing);

}  // namespace flight_corridor::tools
