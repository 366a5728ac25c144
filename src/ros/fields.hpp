#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <variant>

#include "flight_corridor/types.hpp"
#include "ros/values.hpp"

namespace flight_corridor_ros {

/// A parameter's field.
using Field = std::variant<double*, int*, bool*, std::string*, Eigen::Vector3d*>;
/// By key.
using Fields = std::map<std::string, Field>;

/// Puts values into their fields. An int is accepted where a double is expected, not the reverse.
/// @return every unknown key and wrong type, with key and value; those fields are unchanged.
flight_corridor::Violations assign(const Values& values, const Fields& fields);

/// The values that fields have.
Values valuesOf(const Fields& fields);

}  // namespace flight_corridor_ros
