#include "flight_corridor/motion/camera_motion.hpp"

#include <cmath>

namespace flight_corridor {

namespace {

// From one step of a told pose to the next it changes by no more, or it has jumped: a loop was closed, a filter reset.
constexpr double kJump_m = 0.1, kJump_mps2 = 30.0, kJump_rad = 0.1, kJump_radps2 = 20.0;
constexpr double kFastestCamera_mps = 20.0, kFastestCamera_radps = 5.0;  // as long as no step is known
constexpr double kPose_m = 0.01, kPose_rad = 0.005;                      // one sigma of a told motion between pairs
constexpr double kLongestGap_s = 1.0;                // between pairs: what the images show then is another view
constexpr double kLookEvery_s = 0.15;                // told motion is compared with the images now and then
constexpr double kWay_s = 1.0, kLongestWay_s = 5.0;  // that is compared

/// A pose behind that of a key image.
CameraPose after(const CameraPose& key, const RelativePose& moved) {
  return {key.T_M_C * moved.T_K_C,
          key.series,
          {key.translation.sum(), moved.sigma_m * moved.sigma_m},
          {key.rotation.sum(), moved.sigma_rad * moved.sigma_rad}};
}

}  // namespace

std::optional<RelativePose> motionBetween(const CameraPose& earlier, const CameraPose& later) {
  if (earlier.series != later.series) return std::nullopt;
  const auto sigma = [](double told, const PoseVariance& from, const PoseVariance& to) {
    return std::hypot(told, std::sqrt(varianceBetween(from, to)));
  };
  const RelativePose motion{earlier.T_M_C.inverse() * later.T_M_C,
                            sigma(kPose_m, earlier.translation, later.translation),
                            sigma(kPose_rad, earlier.rotation, later.rotation)};
  if (!(motion.sigma_m <= kMostError_m) || !std::isfinite(motion.sigma_rad)) return std::nullopt;
  return motion;
}

void CameraMotion::update(double stamp_s, const cv::Mat& left, const cv::Mat& disparity_px,
                          const ScaleCorrection& correction, const std::optional<Eigen::Isometry3d>& told_W_C) {
  const bool is_gap = !(stamp_s - stamp_s_ <= kLongestGap_s);
  stamp_s_ = stamp_s;
  if (!told_W_C && is_told_ && stamp_s - told_s_ <= kLongestGap_s) return bridge(left, disparity_px, correction);
  const bool goes_on = told_W_C.has_value() == is_told_ && !is_gap;
  is_told_ = told_W_C.has_value();
  if (is_told_) {
    const double since_s = stamp_s - told_s_;
    const bool is_same = goes_on && !isJump(*told_W_C, since_s);
    if (!is_same) begun_s_ = kNaN;
    series_ += !is_same;
    step_ = is_same ? told_W_C_.inverse() * *told_W_C : Eigen::Isometry3d::Identity();
    step_s_ = is_same ? since_s : kNaN;
    told_W_C_ = *told_W_C;
    told_s_ = stamp_s;
    pose_ = CameraPose{*told_W_C, series_};
    compare(left, disparity_px, correction);
  } else {
    if (!goes_on) {
      witness_.forget();
      key_ = {Eigen::Isometry3d::Identity(), ++series_};
    }
    follow(left, disparity_px, correction);
  }
}

/// As if it had gone on as in the step before, but for what it may have accelerated.
bool CameraMotion::isJump(const Eigen::Isometry3d& told_W_C, double since_s) const {
  if (!(since_s > 0.0)) return false;
  const double share = std::isnan(step_s_) ? 0.0 : since_s / step_s_;
  const Eigen::Isometry3d moved = told_W_C_.inverse() * told_W_C;
  const Eigen::AngleAxisd turn(step_.linear());
  const Eigen::Matrix3d expected = Eigen::AngleAxisd(share * turn.angle(), turn.axis()).toRotationMatrix();
  const double squared_s2 = std::pow(std::max(since_s, std::isnan(step_s_) ? since_s : step_s_), 2);
  const double first_m = std::isnan(step_s_) ? kFastestCamera_mps * since_s : 0.0;
  const double first_rad = std::isnan(step_s_) ? kFastestCamera_radps * since_s : 0.0;
  return (moved.translation() - share * step_.translation()).norm() > kJump_m + kJump_mps2 * squared_s2 + first_m ||
         Eigen::AngleAxisd(expected.transpose() * moved.linear()).angle() >
             kJump_rad + kJump_radps2 * squared_s2 + first_rad;
}

/// Until the next pose is told, the images tell the way from the key image on.
void CameraMotion::bridge(const cv::Mat& left, const cv::Mat& disparity_px, const ScaleCorrection& correction) {
  pose_.reset();
  if (std::isnan(begun_s_)) return;
  if (const auto moved = odometry_.track(left, disparity_px, correction)) {
    pose_ = after({told_W_K_, series_}, *moved);
  }
}

/// The pose by the images alone. Where they lose it a new series begins.
void CameraMotion::follow(const cv::Mat& left, const cv::Mat& disparity_px, const ScaleCorrection& correction) {
  const auto moved = odometry_.track(left, disparity_px, correction);
  if (moved && key_.series > 0) {
    pose_ = after(key_, *moved);
    if (odometry_.needsKey()) setKey(disparity_px, correction, *pose_);
  } else {
    setKey(disparity_px, correction, {Eigen::Isometry3d::Identity(), ++series_});
    pose_ = odometry_.hasKey() ? std::optional(key_) : std::nullopt;
  }
}

/// While the images contradict the told motion there is no pose.
void CameraMotion::compare(const cv::Mat& left, const cv::Mat& disparity_px, const ScaleCorrection& correction) {
  const Eigen::Isometry3d told_W_C = pose_->T_M_C;
  const bool is_new = std::isnan(begun_s_);
  if (!is_new && stamp_s_ - looked_s_ < kLookEvery_s) {
    if (is_contradicted_) pose_.reset();
    return;
  }
  looked_s_ = stamp_s_;
  const Eigen::Isometry3d told_K_C = told_W_K_.inverse() * told_W_C;
  const auto moved = odometry_.track(left, disparity_px, correction, is_new ? Eigen::Isometry3d::Identity() : told_K_C);
  const bool is_lost = is_new || !moved;
  is_contradicted_ = !is_lost && MotionWitness::disagrees(stamp_s_ - key_s_, told_K_C, *moved);
  if (is_contradicted_) pose_.reset();
  CameraPose seen = is_lost ? CameraPose() : after(key_, *moved);
  const Eigen::Isometry3d told_S_C = told_W_S_.inverse() * told_W_C;
  const double way_s = stamp_s_ - begun_s_;
  const bool is_long =
      !is_lost && way_s >= kWay_s &&
      (MotionWitness::isComparable(told_S_C) || MotionWitness::isComparable(seen.T_M_C) || way_s >= kLongestWay_s);
  if (is_long) {
    witness_.add(way_s, told_S_C, {seen.T_M_C, std::sqrt(seen.translation.sum()), std::sqrt(seen.rotation.sum())});
    seen = CameraPose();
  }
  if (is_lost || is_long) {
    begun_s_ = stamp_s_;
    told_W_S_ = told_W_C;
  } else if (!odometry_.needsKey()) {
    return;
  }
  told_W_K_ = told_W_C;
  key_s_ = stamp_s_;
  setKey(disparity_px, correction, seen);
}

void CameraMotion::setKey(const cv::Mat& disparity_px, const ScaleCorrection& correction, const CameraPose& at) {
  odometry_.setKey(disparity_px, correction);
  key_ = at;
}

}  // namespace flight_corridor
