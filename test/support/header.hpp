#pragma once

#include <std_msgs/Header.h>

#include <string>

namespace flight_corridor_ros::test_support {

inline std_msgs::Header header(const std::string& frame) {
  std_msgs::Header header;
  header.frame_id = frame;
  header.stamp = ros::Time(12, 500000000);
  return header;
}

}  // namespace flight_corridor_ros::test_support
