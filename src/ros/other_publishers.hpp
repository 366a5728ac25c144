#pragma once

#include <string>
#include <vector>

namespace flight_corridor_ros {

/// Names of the nodes that publish a topic, without this one, by the master's API. Asks over the network.
/// @param topic resolved.
/// @return empty also if the master does not answer.
std::vector<std::string> otherPublishers(const std::string& topic);

}  // namespace flight_corridor_ros
