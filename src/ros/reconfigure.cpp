#include "ros/reconfigure.hpp"

#include <dynamic_reconfigure/ConfigDescription.h>
#include <ros/console.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>
#include <variant>

namespace flight_corridor_ros {

namespace {

using dynamic_reconfigure::Config;
using dynamic_reconfigure::ConfigDescription;

/// A parameter that may change in flight. The limits are those of a slider; the rules are check()'s.
struct Changeable {
  const char* key;
  double min, max;
  const char* description;
};

constexpr std::array<Changeable, 8> kChangeable{{
    {"corridor/width_m", 0.1, 5.0, "[m] width of the corridor's box"},
    {"corridor/height_m", 0.1, 5.0, "[m] height of the corridor's box"},
    {"corridor/length_m", 0.5, 20.0, "[m] D_min: nearer obstacles block"},
    {"corridor/margin_m", 0.0, 2.0, "[m] added on every side and at the end"},
    {"corridor/smallest_obstacle_m", 0.0, 0.5, "[m] edge of a square: smaller patches of matches are dropped"},
    {"corridor/hold_s", 0.0, 5.0, "[s] no FREE for this long after an obstacle that images may miss"},
    {"corridor/max_age_s", 0.05, 5.0, "[s] older evidence: UNKNOWN"},
    {"ros/watchdog_s", 0.1, 5.0, "[s] after this long without a verdict, UNKNOWN is published"},
}};

dynamic_reconfigure::DoubleParameter named(const char* key, double value) {
  dynamic_reconfigure::DoubleParameter parameter;
  parameter.name = key;
  parameter.value = value;
  return parameter;
}

/// The changeable parameters with the values that a function gives, in the one group that clients expect.
template <typename ValueOf>
Config toMessage(ValueOf valueOf) {
  Config message;
  for (const Changeable& parameter : kChangeable) message.doubles.push_back(named(parameter.key, valueOf(parameter)));
  message.groups.emplace_back();
  message.groups.back().name = "Default";
  message.groups.back().state = true;
  return message;
}

Config toMessage(const NodeConfig& config) {
  const Values values = toValues(config);
  return toMessage([&](const Changeable& parameter) { return std::get<double>(values.at(parameter.key)); });
}

ConfigDescription describeParameters() {
  ConfigDescription message;
  message.groups.emplace_back();
  message.groups.back().name = "Default";
  for (const Changeable& parameter : kChangeable) {
    dynamic_reconfigure::ParamDescription description;
    description.name = parameter.key;
    description.type = "double";
    description.description = parameter.description;
    message.groups.back().parameters.push_back(description);
  }
  message.min = toMessage([](const Changeable& parameter) { return parameter.min; });
  message.max = toMessage([](const Changeable& parameter) { return parameter.max; });
  message.dflt = toMessage(NodeConfig());
  return message;
}

std::string inOneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

std::vector<std::string> changeableKeys() {
  std::vector<std::string> keys;
  for (const Changeable& parameter : kChangeable) keys.emplace_back(parameter.key);
  return keys;
}

NodeConfig changed(const NodeConfig& config, const Config& request) {
  Values values = toValues(config);
  flight_corridor::Violations fixed;
  const std::vector<std::string> changeable = changeableKeys();
  const auto take = [&](const auto& parameters) {
    for (const auto& parameter : parameters) {
      const bool may_change = std::count(changeable.begin(), changeable.end(), parameter.name) > 0;
      const Value value(parameter.value);
      if (!may_change) fixed.push_back(parameter.name + ": cannot change in flight (" + describe(value) + ")");
      values[parameter.name] = value;
    }
  };
  take(request.doubles);
  take(request.ints);
  take(request.strs);
  for (const auto& parameter : request.bools) fixed.push_back(parameter.name + ": cannot change in flight");
  flight_corridor::throwIfBroken(fixed);
  return makeConfig(values);
}

Reconfigure::Reconfigure(const ros::NodeHandle& private_node, const NodeConfig& config, Inbox& inbox, Apply apply)
    : node_(private_node), config_(config), inbox_(inbox), apply_(std::move(apply)) {
  node_.setCallbackQueue(&questions_);
  constexpr bool kLatched = true;
  descriptions_ = node_.advertise<ConfigDescription>("parameter_descriptions", 1, kLatched);
  updates_ = node_.advertise<Config>("parameter_updates", 1, kLatched);
  descriptions_.publish(describeParameters());
  announce();
  server_ = node_.advertiseService("set_parameters", &Reconfigure::answer, this);
  spinner_.start();
}

bool Reconfigure::answer(dynamic_reconfigure::ReconfigureRequest& request,
                         dynamic_reconfigure::ReconfigureResponse& response) {
  try {
    const NodeConfig wanted = changed(config_, request.config);
    inTakersThread(inbox_, [this, wanted] { apply_(wanted); });
    config_ = wanted;
    announce();
  } catch (const std::invalid_argument& error) {
    ROS_WARN("parameters are unchanged: %s", inOneLine(error.what()).c_str());
  }
  response.config = toMessage(config_);
  return true;
}

void Reconfigure::announce() {
  writeParameters(node_, toValues(config_));
  updates_.publish(toMessage(config_));
}

}  // namespace flight_corridor_ros
