#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Log.h>
#include <sensor_msgs/Range.h>

#include <limits>
#include <map>
#include <string>
#include <vector>

namespace flight_corridor_ros::test_support {

/// What /diagnostics says of a node.
struct Status {
  int level = -1;
  std::string summary;
  std::map<std::string, std::string> values;

  double number(const std::string& key) const {
    const auto found = values.find(key);
    return found == values.end() ? std::numeric_limits<double>::quiet_NaN() : std::stod(found->second);
  }
};

/// Listens to one range_serial.
class RangeSerialListener {
 public:
  explicit RangeSerialListener(const std::string& name) : name_(name) {
    ranges_ = node_.subscribe<sensor_msgs::Range>("/" + name + "/range", 10000, [this](const auto& message) {
      ranges.push_back(*message);
      arrivals.push_back(ros::Time::now());
    });
    diagnostics_ = node_.subscribe<diagnostic_msgs::DiagnosticArray>("/diagnostics", 100,
                                                                     [this](const auto& message) { take(*message); });
    log_ = node_.subscribe<rosgraph_msgs::Log>("/rosout", 1000, [this](const auto& message) {
      if (message->name == "/" + name_ && message->level >= rosgraph_msgs::Log::WARN) warnings.push_back(message->msg);
    });
  }

  std::vector<sensor_msgs::Range> ranges;
  std::vector<ros::Time> arrivals;  // of them here
  std::vector<std::string> warnings;
  Status status;  // the newest

 private:
  void take(const diagnostic_msgs::DiagnosticArray& message) {
    for (const auto& reported : message.status) {
      if (reported.name.find(name_ + ":") == std::string::npos) continue;
      status = {reported.level, reported.message, {}};
      for (const auto& value : reported.values) status.values[value.key] = value.value;
    }
  }

  std::string name_;
  ros::NodeHandle node_;
  ros::Subscriber ranges_, diagnostics_, log_;
};

}  // namespace flight_corridor_ros::test_support
