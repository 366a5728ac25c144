#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <string>

namespace flight_corridor_ros {

/// A file of camera_calibration (YAML), or a CameraInfo as rostopic echo prints it, without a header.
/// @throws std::invalid_argument naming every key that is missing or wrong.
sensor_msgs::CameraInfo parseCameraInfo(const std::string& text);
/// Reads the calibration for rectifying raw images.
/// @throws std::invalid_argument like parseCameraInfo, naming the file; also if R is all 0.
sensor_msgs::CameraInfo readCameraInfo(const std::string& path);

}  // namespace flight_corridor_ros
