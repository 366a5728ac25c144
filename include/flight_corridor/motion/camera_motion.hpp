#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "flight_corridor/motion/motion_witness.hpp"
#include "flight_corridor/motion/visual_odometry.hpp"

namespace flight_corridor {

/// Variance of a pose since its series began; of a told one 0.
struct PoseVariance {
  double key = 0.0;  ///< Of the key image that it was tracked from: poses of one key image have it in common.
  double own = 0.0;  ///< Since that image.
  double sum() const { return key + own; }
};
/// Of the motion from an earlier pose to a later one.
inline double varianceBetween(const PoseVariance& earlier, const PoseVariance& later) {
  return later.key - earlier.key + earlier.own + later.own;
}

/// A pose of the camera in a frame M that stands still.
struct CameraPose {
  Eigen::Isometry3d T_M_C = Eigen::Isometry3d::Identity();
  int series = 0;                 ///< Poses of another series cannot be compared with it.
  PoseVariance translation = {};  ///< [m^2]
  PoseVariance rotation = {};     ///< [rad^2]
};

constexpr double kMostError_m = 0.03;  ///< One sigma: places and motions that are less certain are not compared.

/// From an earlier pose to a later one, for comparing what was seen from both; nullopt: they are of different series,
/// or less certain than kMostError_m.
std::optional<RelativePose> motionBetween(const CameraPose& earlier, const CameraPose& later);

/// Where the camera is, for comparing pairs: by poses that are told, else by its images; and whether the two agree. One
/// object, one thread.
class CameraMotion {
 public:
  explicit CameraMotion(const StereoGeometry& geometry) : odometry_(geometry) {}

  /// A pair, not older than the last.
  /// @param left CV_8UC1.  @param disparity_px its matches, CV_32FC1 [px], NaN = no match.  @param correction of these.
  /// @param told_W_C pose in a fixed frame by others; absent: unknown.
  /// Told poses may be missing for up to a second: the images tell what lies between.
  void update(double stamp_s, const cv::Mat& left, const cv::Mat& disparity_px, const ScaleCorrection& correction,
              const std::optional<Eigen::Isometry3d>& told_W_C);

  /// At the last pair; nullopt: neither told nor shown by the images, or told, but the images just contradict it.
  const std::optional<CameraPose>& pose() const { return pose_; }
  /// Told motion against that of the images.
  const MotionWitness& witness() const { return witness_; }

 private:
  void bridge(const cv::Mat& left, const cv::Mat& disparity_px, const ScaleCorrection& correction);
  void follow(const cv::Mat& left, const cv::Mat& disparity_px, const ScaleCorrection& correction);
  void compare(const cv::Mat& left, const cv::Mat& disparity_px, const ScaleCorrection& correction);
  void setKey(const cv::Mat& disparity_px, const ScaleCorrection& correction, const CameraPose& at);

  VisualOdometry odometry_;
  MotionWitness witness_;
  bool isJump(const Eigen::Isometry3d& told_W_C, double since_s) const;

  double stamp_s_ = kNaN;
  bool is_told_ = false;
  double told_s_ = kNaN, step_s_ = kNaN;  // stamp of the last told pose, and time since the one before
  Eigen::Isometry3d told_W_C_ = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d step_ = Eigen::Isometry3d::Identity();  // from the one before
  int series_ = 0;
  std::optional<CameraPose> pose_;
  CameraPose key_;  // pose of the key image, by the images
  // The way that is compared.
  Eigen::Isometry3d told_W_S_ = Eigen::Isometry3d::Identity();  // its start, as told
  Eigen::Isometry3d told_W_K_ = Eigen::Isometry3d::Identity();  // the key image, as told
  double begun_s_ = kNaN, looked_s_ = kNaN, key_s_ = kNaN;      // stamps: its start, the last look, the key image
  bool is_contradicted_ = false;                                // by the last look
};

}  // namespace flight_corridor
