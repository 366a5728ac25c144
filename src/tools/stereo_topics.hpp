#pragma once

#include <string>

namespace flight_corridor::tools {

/// Topics of the rig's data in a bag. Empty ones are searched, see topic_finder.
struct StereoTopics {
  std::string left = "/stereo/left/image_rect";
  std::string left_info = "/stereo/left/camera_info";
  std::string right = "/stereo/right/image_rect";
  std::string right_info = "/stereo/right/camera_info";
  std::string range = "/range";
  std::string imu = "/imu";
  std::string odom = "/odom";
};

constexpr char kTransformTopic[] = "/tf";
constexpr char kStaticTransformTopic[] = "/tf_static";

}  // namespace flight_corridor::tools
