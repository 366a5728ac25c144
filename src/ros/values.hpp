#pragma once

#include <ros/node_handle.h>

#include <map>
#include <string>
#include <variant>
#include <vector>

namespace flight_corridor_ros {

/// One parameter, typed as in YAML or on the parameter server.
using Value = std::variant<std::monostate, bool, int, double, std::string, std::vector<double>>;
/// Parameters by key, "section/name"; monostate: a type that no parameter has.
using Values = std::map<std::string, Value>;

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

/// A value as text, for messages.
std::string describe(const Value& value);

}  // namespace flight_corridor_ros
