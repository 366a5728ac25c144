#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "sim/render.hpp"

namespace flight_corridor::sim {

/// One camera's path from light to grey levels.
struct ImageSensor {
  double gain = 200.0;       ///< Grey levels per unit of radiance.
  double black_level = 4.0;  ///< [grey levels]
  double blur_sigma_px = 0.6;
  double read_noise = 0.8;    ///< Standard deviation in the dark [grey levels].
  double shot_noise = 0.012;  ///< Variance per grey level of signal [grey levels].
  int streaks = 0;            ///< Rain drops before the lens, drawn out by the exposure.
};

/// Stereo cameras and the LiDAR's place on the body. The images are made with the true rig; the calibration is what the
/// rig announces.
struct Rig {
  StereoCalibration calibration;
  double baseline_error = 0.0;       ///< (true - announced) / announced [-].
  double disparity_offset_px = 0.0;  ///< Measured minus true disparity: the right camera is a little yawed.
  double vertical_shift_px = 0.0;    ///< Rows by which the right image is too low.
  Eigen::Isometry3d T_B_C = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_B_L = Eigen::Isometry3d::Identity();
  double exposure_s = 0.0;  ///< Centred on the stamp; 0 = no motion blur.
  ImageSensor left;
  ImageSensor right;
};

/// R_B_C: turns an optical frame (z forward, x right, y down) into forward-left-up.
Eigen::Matrix3d forwardFromOptical();

/// A rig like a small quadrotor's: ZED-like VGA pair with 0.12 m baseline, LiDAR below and beside the left camera.
Rig defaultRig();

/// The same field of view with fewer or more pixels.
void scaleImages(Rig& rig, double factor);

/// The cameras as they truly are.
Camera leftCamera(const Rig& rig, const Eigen::Isometry3d& T_W_B);
Camera rightCamera(const Rig& rig, const Eigen::Isometry3d& T_W_B);

/// Rain streaks, blur, exposure, read and shot noise, saturation.
/// @param radiance CV_32FC1.  @return CV_8UC1.
cv::Mat expose(const cv::Mat& radiance, const ImageSensor& sensor, std::uint64_t seed);

}  // namespace flight_corridor::sim
