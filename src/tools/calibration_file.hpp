#pragma once

#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "tools/stereo_cameras.hpp"

namespace flight_corridor::tools {

/// The use of a calibration.
struct ImageFormat {
  cv::Size size_px;
  bool is_colour = false;  ///< KITTI's grey and colour pairs have calibrations of their own.
  PairNames topics = {};   ///< Of the images; empty: not known.
  PairNames cameras = {};  ///< In a file that names its cameras; empty: by the topics, else the file's order.
};

/// Reads a pair's calibration from one file, or from two: left, right. Its content decides its kind; calibrationKinds()
/// lists those that are read. Baselines of Middlebury and ZED files are in millimetres, all others in metres.
/// A Kalibr chain's cameras are chosen by choosePair.
/// @throws std::runtime_error naming the files, every key that is missing or not a number, impossible values, and, if a
/// file of another kind is recognised, that kind and the conversion of its numbers.
StereoCameras readCalibration(const std::vector<std::string>& paths, const ImageFormat& images);

/// The kinds of files that are read, a line each, for --help.
std::string calibrationKinds();

}  // namespace flight_corridor::tools
