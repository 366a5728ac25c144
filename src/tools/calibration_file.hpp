#pragma once

#include <opencv2/core/types.hpp>
#include <string>

#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor::tools {

/// Reads a rectified pair's calibration: YAML with the keys fx fy cx cy doffs [px] and baseline [m]; cx_right = cx +
/// doffs. Other keys may be there.
/// @param size_px of the images.
/// @throws std::runtime_error naming the file and every key that is missing or no number, what is impossible, and,
/// where another tool's file is recognised, which and how its numbers are converted.
StereoCalibration readCalibration(const std::string& path, cv::Size size_px);

}  // namespace flight_corridor::tools
