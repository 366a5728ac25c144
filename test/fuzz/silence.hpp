#pragma once

#include <console_bridge/console.h>
#include <ros/console.h>

namespace flight_corridor::fuzz {

/// Warnings by the thousand hide a finding.
inline void silenceRos() {
  ros::console::set_logger_level(ROSCONSOLE_DEFAULT_NAME, ros::console::levels::Fatal);
  ros::console::notifyLoggerLevelsChanged();
  console_bridge::noOutputHandler();  // tf2's
}

}  // namespace flight_corridor::fuzz
