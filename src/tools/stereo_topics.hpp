#pragma once

#include <string>

namespace flight_corridor::tools {

/// Where a bag holds the rig's data. What is empty is to be found, see topic_finder.
struct StereoTopics {
  std::string left = "/stereo/left/image_rect";
  std::string left_info = "/stereo/left/camera_info";
  std::string right = "/stereo/right/image_rect";
  std::string right_info = "/stereo/right/camera_info";
  std::string range = "/range";
  std::string imu = "/imu";
};

constexpr char kTransformTopic[] = "/tf";
constexpr char kStaticTransformTopic[] = "/tf_static";

}  // namespace flight_corridor::tools
