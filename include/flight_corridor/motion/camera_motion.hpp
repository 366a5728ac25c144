#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "flight_corridor/motion/motion_witness.hpp"
#include "flight_corridor/motion/visual_odometry.hpp"

namespace flight_corridor {

/// A pose of the camera in a frame M that stands still.
struct CameraPose {
  Eigen::Isometry3d T_M_C = Eigen::Isometry3d::Identity();
  int series = 0;              ///< Poses of another series cannot be compared with it.
  double variance_m2 = 0.0;    ///< Of the translation since the series began; of told poses 0.
  double variance_rad2 = 0.0;  ///< Of the rotation.
};

/// Where the camera is, for comparing pairs: by poses that are told, else by its images; and whether the two agree. One
/// object, one thread.
class CameraMotion {
 public:
  explicit CameraMotion(const StereoGeometry& geometry) : odometry_(geometry) {}

  /// A pair, not older than the last.
  /// @param left CV_8UC1.  @param disparity_px its matches, CV_32FC1 [px], NaN = no match.  @param correction of these.
  /// @param told_W_C pose in a fixed frame by others; absent: unknown.
  void update(double stamp_s, const cv::Mat& left, const cv::Mat& disparity_px, const ScaleCorrection& correction,
              const std::optional<Eigen::Isometry3d>& told_W_C);

  /// At the last pair; nullopt: neither told nor shown by the images.
  const std::optional<CameraPose>& pose() const { return pose_; }
  /// Told motion against that of the images.
  const MotionWitness& witness() const { return witness_; }

 private:
  void follow(const cv::Mat& left, const cv::Mat& disparity_px, const ScaleCorrection& correction);
  void compare(const cv::Mat& left, const cv::Mat& disparity_px, const ScaleCorrection& correction);
  void setKey(const cv::Mat& disparity_px, const ScaleCorrection& correction, const CameraPose& at);

  VisualOdometry odometry_;
  MotionWitness witness_;
  double stamp_s_ = kNaN;
  bool is_told_ = false;
  std::optional<CameraPose> pose_;
  CameraPose key_;  // pose of the key image, by the images
  // The way that is compared.
  Eigen::Isometry3d told_W_S_ = Eigen::Isometry3d::Identity();  // its start, as told
  Eigen::Isometry3d told_W_K_ = Eigen::Isometry3d::Identity();  // the key image, as told
  double begun_s_ = kNaN, looked_s_ = kNaN;
};

}  // namespace flight_corridor
