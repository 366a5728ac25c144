#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <string>

namespace flight_corridor_ros {

/// The calibration in a file of camera_calibration (YAML), without a header.
/// @throws std::invalid_argument naming the file and every key that is missing or does not hold what it should.
sensor_msgs::CameraInfo readCameraInfo(const std::string& path);

}  // namespace flight_corridor_ros
