#pragma once

#include <string>
#include <vector>

#include "tools/stereo_cameras.hpp"

namespace flight_corridor::tools {

struct ImageFormat;
using CalibrationTexts = std::vector<std::string>;  ///< Of the files, in the order in which they were given.

// Calibrations in YAML. All throw std::runtime_error naming key and fault, and how many files are wanted where it is
// another number. Where the file has no image size, that of the images is taken.

/// One file: cam0, cam1 and so on with intrinsics, distortion, rostopic and, but of the first, T_cn_cnm1. Of the pair
/// that choosePair chooses.
StereoCameras readKalibr(const CalibrationTexts& texts, const ImageFormat& images);
/// Two files: intrinsics, distortion and T_BS.
StereoCameras readEuroc(const CalibrationTexts& texts, const ImageFormat& images);
/// Two files of camera_calibration (ost.yaml), or two CameraInfos as rostopic echo prints them.
StereoCameras readRos(const CalibrationTexts& texts, const ImageFormat& images);
/// One file or more: K1 D1 K2 D2 with R and T, or with R1 P1 R2 P2, under OpenCV's usual names; P1 P2 alone for
/// rectified images. YAML or XML.
StereoCameras readOpenCv(const CalibrationTexts& texts, const ImageFormat& images);

}  // namespace flight_corridor::tools
