#pragma once

#include "tools/calibration_yaml.hpp"

namespace flight_corridor::tools {

// Calibrations in plain text, one file for both cameras. All throw std::runtime_error naming key and fault.

/// P0 to P3, or P_rect_00 to P_rect_03: of colour images the pair 2, 3 if it exists, else 0, 1. Rectified.
StereoCameras readKitti(const CalibrationTexts& texts, const ImageFormat& images);
/// cam0, cam1, doffs [px] and baseline [mm]. Rectified.
StereoCameras readMiddlebury(const CalibrationTexts& texts, const ImageFormat& images);
/// The sections of the images' size, and STEREO: Baseline, TY, TZ [mm], RX, CV, RZ [rad]. Raw.
StereoCameras readZed(const CalibrationTexts& texts, const ImageFormat& images);

}  // namespace flight_corridor::tools
