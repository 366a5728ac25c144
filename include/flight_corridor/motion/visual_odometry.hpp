#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/range/scale_correction.hpp"

namespace flight_corridor {

/// A pose of the camera relative to an earlier one, with the uncertainty of both its parts.
struct RelativePose {
  Eigen::Isometry3d T_K_C = Eigen::Isometry3d::Identity();  ///< Camera now, C, in the camera of then, K.
  double sigma_m = 0.0;                                     ///< Of the translation, along its worst direction.
  double sigma_rad = 0.0;                                   ///< Of the rotation, about its worst axis.

  /// One sigma of where a point at a depth is [m].
  double error(double depth_m) const { return std::hypot(sigma_m, sigma_rad * depth_m); }
};

/// The camera's motion by its images: corners of an earlier left image, the key image, with their matched depths, are
/// tracked (pyramidal Lucas-Kanade, Bouguet 2001). The pose is that by which they are seen where they are, and as far
/// as they are matched now: perspective n-point by RANSAC, then least squares. One object, one thread.
class VisualOdometry {
 public:
  explicit VisualOdometry(const StereoGeometry& geometry) : geometry_(geometry) {}

  /// The pose relative to the key image.
  /// @param left CV_8UC1.  @param disparity_px its matches, CV_32FC1 [px], NaN = no match.  @param correction of these.
  /// @param guess T_K_C as others know it; absent: as if the last motion went on.
  /// @return nullopt without a key image, or if too few corners agree on one motion: lost.
  std::optional<RelativePose> track(const cv::Mat& left, const cv::Mat& disparity_px, const ScaleCorrection& correction,
                                    const std::optional<Eigen::Isometry3d>& guess = std::nullopt);

  /// Makes the image of the last track() the key image.
  /// @param disparity_px its matches, CV_32FC1 [px], NaN = no match.  @param correction of these.
  void setKey(const cv::Mat& disparity_px, const ScaleCorrection& correction);

  /// Whether there is a key image with corners enough.
  bool hasKey() const;

  /// Whether the key image still shows enough of what is in view.
  bool needsKey() const { return 2 * tracked_.size() < corners_.size() || corners_.empty(); }

 private:
  /// A corner that was found again.
  struct Corner {
    Eigen::Vector3d p_K;       // in space
    double depth_error = 0.0;  // one sigma of its depth, relative
    Eigen::Vector3d seen_px;   // now: u, v, and its disparity, NaN where it is not matched
  };
  using Normal = Eigen::Matrix<double, 6, 6>;

  bool follow(const cv::Mat& disparity_px, const ScaleCorrection& correction, const Eigen::Isometry3d& guess_C_K);
  std::optional<Eigen::Isometry3d> agree();
  Normal refine(Eigen::Isometry3d& T_C_K) const;

  StereoGeometry geometry_;
  std::vector<cv::Mat> pyramid_, key_pyramid_;  // of the half-sized image of now, and of the key image
  std::vector<cv::Point2f> corners_;            // of the key image, in its half-sized pixels
  std::vector<Eigen::Vector3d> points_K_;       // ... in space
  std::vector<cv::Point2f> seen_, back_;        // ... in the image of now, and tracked back from there
  std::vector<Corner> tracked_;
  Eigen::Isometry3d last_K_C_ = Eigen::Isometry3d::Identity(), step_ = Eigen::Isometry3d::Identity();
};

}  // namespace flight_corridor
