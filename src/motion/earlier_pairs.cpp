#include "flight_corridor/motion/earlier_pairs.hpp"

#include <cmath>
#include <utility>

namespace flight_corridor {

namespace {

constexpr double kApart_m = 0.05, kApart_s = 0.1;  // between two pairs that are kept
constexpr std::size_t kMostPairs = 16;
constexpr int kVotes = 2;             // earlier pairs that must have seen a place clear
constexpr double kMost_m = 0.03;      // one sigma: with a less certain pose nothing is remembered
constexpr double kPose_m = 0.01;      // one sigma of a told pose's motion between pairs

}  // namespace

void EarlierPairs::add(double stamp_s, const CameraPose& pose, cv::Mat& met_left_px, cv::Mat& met_right_px) {
  if (!pairs_.empty() && pairs_.back().pose.series != pose.series) pairs_.clear();
  const auto isApart = [&](const Pair& last) {
    return stamp_s - last.stamp_s >= kApart_s ||
           (pose.T_M_C.translation() - last.pose.T_M_C.translation()).norm() >= kApart_m;
  };
  if (!pairs_.empty() && !isApart(pairs_.back())) return;
  Pair pair;
  if (pairs_.size() == kMostPairs) {
    pair = std::move(pairs_.front());
    pairs_.pop_front();
  }
  pair.stamp_s = stamp_s;
  pair.pose = pose;
  pair.met_left_px.create(met_left_px.size(), met_left_px.type());
  pair.met_right_px.create(met_right_px.size(), met_right_px.type());
  std::swap(pair.met_left_px, met_left_px);
  std::swap(pair.met_right_px, met_right_px);
  pairs_.push_back(std::move(pair));
}

void EarlierPairs::moveTo(double stamp_s, const std::optional<CameraPose>& pose, double memory_s) {
  views_.clear();
  while (!pairs_.empty() && !(stamp_s - pairs_.front().stamp_s <= memory_s)) pairs_.pop_front();
  if (!pose) return;
  for (auto pair = pairs_.rbegin(); pair != pairs_.rend(); ++pair) {
    if (pair->pose.series != pose->series) continue;
    const double sigma_m = std::hypot(kPose_m, std::sqrt(std::max(0.0, pose->variance_m2 - pair->pose.variance_m2)));
    const double sigma_rad = std::sqrt(std::max(0.0, pose->variance_rad2 - pair->pose.variance_rad2));
    if (sigma_m <= kMost_m) views_.push_back({&*pair, pair->pose.T_M_C.inverse() * pose->T_M_C, sigma_m, sigma_rad});
  }
}

EarlierPairs::Plane EarlierPairs::plane(double depth_m) const {
  const StereoCalibration& rig = geometry_.calibration();
  Plane plane;
  plane.focal_baseline_px_m_ = static_cast<float>(geometry_.disparity(1.0));
  plane.shift_px_ = static_cast<float>(geometry_.principalPointDifference());
  plane.focal_px_ = static_cast<float>(rig.fx_px);
  Eigen::Matrix3d K;
  K << rig.fx_px, 0.0, rig.cx_px, 0.0, rig.fy_px, rig.cy_px, 0.0, 0.0, 1.0;
  const auto seen = [&](const View& view, int u, int v) {
    return Eigen::Vector3d(K * (view.T_E_C * geometry_.point(u, v, depth_m)));
  };
  for (const View& view : views_) {
    const Eigen::Vector3d corner = seen(view, 0, 0);
    plane.views_.push_back({&view.pair->met_left_px, &view.pair->met_right_px, corner.cast<float>(),
                            (seen(view, 1, 0) - corner).cast<float>(), (seen(view, 0, 1) - corner).cast<float>(),
                            static_cast<float>(std::hypot(view.sigma_m, view.sigma_rad * depth_m))});
  }
  return plane;
}

/// In an earlier pair, either camera's rays around the place must be clear beyond it, as far as the pose may be wrong.
bool EarlierPairs::Plane::wasClear(int u, int v) const {
  int votes = 0;
  for (const View& view : views_) {
    const Eigen::Vector3f p = view.corner + static_cast<float>(u) * view.along_u + static_cast<float>(v) * view.along_v;
    if (!(p.z() > view.error_m)) continue;
    const float at_px = focal_baseline_px_m_ / (p.z() + view.error_m);
    const auto reach = static_cast<int>(std::lround(focal_px_ * view.error_m / p.z()));
    const auto column = static_cast<int>(std::lround(p.x() / p.z())), row = static_cast<int>(std::lround(p.y() / p.z()));
    const auto isClear = [&](const cv::Mat& met_px, int at) {
      if (at < reach || row < reach || at >= met_px.cols - reach || row >= met_px.rows - reach) return false;
      const auto* line = met_px.ptr<float>(row);
      return line[at] < at_px && line[at - reach] < at_px && line[at + reach] < at_px &&
             met_px.at<float>(row - reach, at) < at_px && met_px.at<float>(row + reach, at) < at_px;
    };
    const int at_right = column - static_cast<int>(std::lround(focal_baseline_px_m_ / p.z() + shift_px_));
    if ((isClear(*view.left, column) || isClear(*view.right, at_right)) && ++votes >= kVotes) return true;
  }
  return false;
}

}  // namespace flight_corridor
