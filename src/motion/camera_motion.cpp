#include "flight_corridor/motion/camera_motion.hpp"

#include <cmath>

namespace flight_corridor {

namespace {

constexpr double kJump_mps = 20.0, kJump_m = 0.3;  // no small UAV moves faster: a told pose has jumped
constexpr double kLongestGap_s = 1.0;              // between pairs: what the images show then is another view
constexpr double kLookEvery_s = 0.15;              // told motion is compared with the images now and then
constexpr double kWay_s = 1.0;                     // that is compared

/// A pose behind another one.
CameraPose after(const CameraPose& key, const RelativePose& moved) {
  return {key.T_M_C * moved.T_K_C, key.series, key.variance_m2 + moved.sigma_m * moved.sigma_m,
          key.variance_rad2 + moved.sigma_rad * moved.sigma_rad};
}

}  // namespace

void CameraMotion::update(double stamp_s, const cv::Mat& left, const cv::Mat& disparity_px,
                          const ScaleCorrection& correction, const std::optional<Eigen::Isometry3d>& told_W_C) {
  const double since_s = stamp_s - stamp_s_;
  const bool was_told = is_told_;
  stamp_s_ = stamp_s;
  is_told_ = told_W_C.has_value();
  const bool goes_on = was_told == is_told_ && since_s <= kLongestGap_s;
  const int series = pose_ ? pose_->series : key_.series;
  if (is_told_) {
    const bool jumps = pose_ && (told_W_C->translation() - pose_->T_M_C.translation()).norm() > kJump_m + kJump_mps * since_s;
    const bool is_same = goes_on && !jumps;
    if (!is_same) begun_s_ = kNaN;
    pose_ = CameraPose{*told_W_C, is_same ? series : series + 1};
    compare(left, disparity_px, correction);
  } else {
    if (!goes_on) {
      pose_.reset();
      witness_.forget();
      key_ = {Eigen::Isometry3d::Identity(), series + 1};
    }
    follow(left, disparity_px, correction);
  }
}

/// The pose by the images alone. Where they lose it a new series begins.
void CameraMotion::follow(const cv::Mat& left, const cv::Mat& disparity_px, const ScaleCorrection& correction) {
  const auto moved = odometry_.track(left, disparity_px, correction);
  if (moved && key_.series > 0) {
    pose_ = after(key_, *moved);
    if (odometry_.needsKey()) setKey(disparity_px, correction, *pose_);
  } else {
    setKey(disparity_px, correction, {Eigen::Isometry3d::Identity(), key_.series + 1});
    pose_ = odometry_.hasKey() ? std::optional(key_) : std::nullopt;
  }
}

void CameraMotion::compare(const cv::Mat& left, const cv::Mat& disparity_px, const ScaleCorrection& correction) {
  const Eigen::Isometry3d& told_W_C = pose_->T_M_C;
  const bool is_new = std::isnan(begun_s_);
  if (!is_new && stamp_s_ - looked_s_ < kLookEvery_s) return;
  looked_s_ = stamp_s_;
  const Eigen::Isometry3d told_K_C = told_W_K_.inverse() * told_W_C;
  const auto moved = odometry_.track(left, disparity_px, correction, is_new ? Eigen::Isometry3d::Identity() : told_K_C);
  const bool is_lost = is_new || !moved;
  CameraPose seen = is_lost ? CameraPose() : after(key_, *moved);
  const bool is_long = !is_lost && stamp_s_ - begun_s_ >= kWay_s;
  if (is_long) {
    witness_.add(stamp_s_ - begun_s_, told_W_S_.inverse() * told_W_C,
                 {seen.T_M_C, std::sqrt(seen.variance_m2), std::sqrt(seen.variance_rad2)});
    seen = CameraPose();
  }
  if (is_lost || is_long) {
    begun_s_ = stamp_s_;
    told_W_S_ = told_W_C;
  } else if (!odometry_.needsKey()) {
    return;
  }
  told_W_K_ = told_W_C;
  setKey(disparity_px, correction, seen);
}

void CameraMotion::setKey(const cv::Mat& disparity_px, const ScaleCorrection& correction, const CameraPose& at) {
  odometry_.setKey(disparity_px, correction);
  key_ = at;
}

}  // namespace flight_corridor
