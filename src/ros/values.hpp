#pragma once

#include <ros/node_handle.h>

#include <string>

#include "flight_corridor/parameter.hpp"

namespace flight_corridor_ros {

using flight_corridor::describe;
using flight_corridor::Value;
using flight_corridor::Values;

/// Every parameter of a YAML file.
/// @throws std::invalid_argument naming the file if it is missing or not a YAML map.
Values readYaml(const std::string& path);

/// Every parameter of a private namespace on the parameter server.
Values readParameters(const ros::NodeHandle& private_node);

/// Writes parameters to a private namespace on the parameter server.
void writeParameters(const ros::NodeHandle& private_node, const Values& values);

/// Sets one parameter from "key=value", the value as in YAML.
/// @throws std::invalid_argument if there is no key or the value is not YAML.
void setParameter(Values& values, const std::string& key_and_value);

}  // namespace flight_corridor_ros
