#include "ros/reconfigure.hpp"

#include <dynamic_reconfigure/ConfigDescription.h>
#include <ros/console.h>

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <variant>

namespace flight_corridor_ros {

namespace {

using dynamic_reconfigure::Config;
using dynamic_reconfigure::ConfigDescription;

using flight_corridor::Parameter;
using flight_corridor::Parameters;

/// The changeable parameters with the values that a function gives, in the one group that clients expect.
template <typename ValueOf>
Config toMessage(NodeConfig config, ValueOf valueOf) {
  Config message;
  for (const Parameter& parameter : changeable(config)) {
    message.doubles.emplace_back();
    message.doubles.back().name = parameter.key;
    message.doubles.back().value = valueOf(parameter);
  }
  message.groups.emplace_back();
  message.groups.back().name = "Default";
  message.groups.back().state = true;
  return message;
}

Config toMessage(const NodeConfig& config) {
  return toMessage(config, [](const Parameter& parameter) { return *std::get<double*>(parameter.field); });
}

ConfigDescription describeParameters() {
  NodeConfig defaults;
  ConfigDescription message;
  message.groups.emplace_back();
  message.groups.back().name = "Default";
  for (const Parameter& parameter : changeable(defaults)) {
    dynamic_reconfigure::ParamDescription description;
    description.name = parameter.key;
    description.type = "double";
    description.description = parameter.meaning;
    message.groups.back().parameters.push_back(description);
  }
  message.min = toMessage(defaults, [](const Parameter& parameter) { return parameter.rule.slider->first; });
  message.max = toMessage(defaults, [](const Parameter& parameter) { return parameter.rule.slider->second; });
  message.dflt = toMessage(defaults);
  return message;
}

std::string inOneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

Parameters changeable(NodeConfig& config) {
  Parameters rows = parametersOf(tablesOf(config));
  rows.erase(std::remove_if(rows.begin(), rows.end(), [](const Parameter& row) { return !row.rule.slider; }),
             rows.end());
  return rows;
}

NodeConfig changed(const NodeConfig& config, const Config& request) {
  Values values = toValues(config);
  NodeConfig copy = config;
  const Values may_change = valuesOf(changeable(copy));
  flight_corridor::Violations fixed;
  const auto take = [&](const auto& parameters) {
    for (const auto& parameter : parameters) {
      const Value value(parameter.value);
      const std::string complaint = parameter.name + ": cannot change in flight (" + describe(value) + ")";
      if (may_change.count(parameter.name) == 0) fixed.push_back(complaint);
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
