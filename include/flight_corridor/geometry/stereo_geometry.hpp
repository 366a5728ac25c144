#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <opencv2/core/types.hpp>
#include <string>

#include "flight_corridor/types.hpp"

namespace flight_corridor {

constexpr double kSmallestScale = 0.9;  ///< Lower bound of true over measured depth.

/// Projection matrices of a rectified pair, as numbers.
struct StereoCalibration {
  cv::Size size_px;
  double fx_px = kNaN;
  double fy_px = kNaN;
  double cx_px = kNaN;  ///< Principal point of the left image; pixel (0,0) has its centre at (0.0, 0.0).
  double cy_px = kNaN;
  double cx_right_px = kNaN;  ///< Principal point of the right image; may differ from cx_px.
  double baseline_m = kNaN;   ///< Distance of the optical centres, 0.01 to 2.
};

/// What few rectified pairs have, as a sentence with the likely cause: a principal point that may belong to a larger or
/// smaller image, or to all of an image of which a part is shown. "": nothing.
std::string doubtsOf(const StereoCalibration& calibration);

/// T_C_F of a frame F at the camera: x forward along the optical axis, y left, z up.
Eigen::Isometry3d opticalFromForward();

/// Depth, disparity and points of one rectified pair. The only place of f*B/d. Depth is along the optical z axis of C
/// (left rectified optical frame).
class StereoGeometry {
 public:
  /// @throws std::invalid_argument naming every impossible number of the calibration.
  explicit StereoGeometry(const StereoCalibration& calibration);

  const StereoCalibration& calibration() const { return calibration_; }
  cv::Size size() const { return calibration_.size_px; }

  /// Z = f*B/d.  @param disparity_px principal-point difference already removed.  @return [m]; NaN unless d > 0.
  double depth(double disparity_px) const { return disparity_px > 0.0 ? focal_baseline_px_m_ / disparity_px : kNaN; }

  /// d = f*B/Z.  @return [px]; NaN unless Z > 0.
  double disparity(double depth_m) const { return depth_m > 0.0 ? focal_baseline_px_m_ / depth_m : kNaN; }

  /// Edge of a pixel on a surface that faces the camera: Z/f = B/d.
  /// @return [m]; NaN unless d > 0.
  double pixelEdge(double disparity_px) const {
    return disparity_px > 0.0 ? calibration_.baseline_m / disparity_px : kNaN;
  }

  /// sigma_Z = Z^2/(f*B) * sigma_d, first-order propagation of Z = f*B/d.  @return [m].
  double depthSigma(double depth_m, double disparity_sigma_px) const {
    return depth_m * depth_m / focal_baseline_px_m_ * disparity_sigma_px;
  }

  /// Depth of a surface if its disparity were larger by shift_px: fB/(fB/Z + shift).  @return [m]; +inf if the
  /// disparity passes 0.
  template <class Real>
  Real shiftedDepth(Real depth_m, double shift_px) const {
    const Real inverse = Real{1} / depth_m + static_cast<Real>(shift_px / focal_baseline_px_m_);
    return Real{1} / std::max(inverse, Real{0});  // NaN stays NaN
  }

  /// Excess of a matcher's u_l - u_r over disparity: cx_l - cx_r [px].
  double principalPointDifference() const { return calibration_.cx_px - calibration_.cx_right_px; }

  /// Point in C [m] of pixel (u, v) at a depth.
  Eigen::Vector3d point(double u_px, double v_px, double depth_m) const {
    return {(u_px - calibration_.cx_px) / calibration_.fx_px * depth_m,
            (v_px - calibration_.cy_px) / calibration_.fy_px * depth_m, depth_m};
  }

  /// Pixel of a point in C; NaN unless the point lies in front of the camera.
  Eigen::Vector2d project(const Eigen::Vector3d& p_C) const;

  /// Maps a point in C to its homogeneous pixel in the left image.
  Eigen::Matrix3d cameraMatrix() const;

  /// Whether pixel (u, v) lies on the image.
  bool contains(const Eigen::Vector2d& pixel) const;

 private:
  StereoCalibration calibration_;
  double focal_baseline_px_m_;
};

}  // namespace flight_corridor
