#include "flight_corridor/motion/earlier_pairs.hpp"

#include <cmath>
#include <opencv2/core.hpp>
#include <utility>

namespace flight_corridor {

namespace {

constexpr double kApart_m = 0.05, kApart_s = 0.1;  // between two pairs that are kept
constexpr std::size_t kMostPairs = 16;
constexpr int kVotes = 2;             // earlier pairs that must have seen a place clear
constexpr double kMost_m = 0.03;      // one sigma: with a less certain pose nothing is remembered
constexpr int kStride_px = 8;         // between the matches of a pair that are kept
constexpr double kPose_m = 0.01, kPose_rad = 0.005;  // one sigma of a told motion between pairs
constexpr int kVanished = 3;          // points of a square, of four, that are seen no more: at its edge others are

}  // namespace

void EarlierPairs::add(double stamp_s, const CameraPose& pose, const cv::Mat& depth_m, const cv::Mat& textured,
                       cv::Mat& met_left_px, cv::Mat& met_right_px) {
  views_.clear();  // they point into the pairs
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
  pair.surface_C.clear();
  for (int v = kStride_px / 2; v < depth_m.rows; v += kStride_px) {
    for (int u = kStride_px / 2; u < depth_m.cols; u += kStride_px) {
      const float at_m = depth_m.at<float>(v, u);
      if (at_m > 0.0f && textured.at<std::uint8_t>(v, u)) pair.surface_C.push_back(geometry_.point(u, v, at_m).cast<float>());
    }
  }
  pairs_.push_back(std::move(pair));
}

void EarlierPairs::moveTo(double stamp_s, const std::optional<CameraPose>& pose, double memory_s) {
  views_.clear();
  while (!pairs_.empty() && !(stamp_s - pairs_.front().stamp_s <= memory_s)) pairs_.pop_front();
  if (!pose) return;
  for (auto pair = pairs_.rbegin(); pair != pairs_.rend(); ++pair) {
    if (pair->pose.series != pose->series) continue;
    const double sigma_m = std::hypot(kPose_m, std::sqrt(varianceBetween(pair->pose.translation, pose->translation)));
    const double sigma_rad = std::hypot(kPose_rad, std::sqrt(varianceBetween(pair->pose.rotation, pose->rotation)));
    const bool is_certain = sigma_m <= kMost_m && std::isfinite(sigma_rad);
    if (is_certain) views_.push_back({&*pair, pair->pose.T_M_C.inverse() * pose->T_M_C, sigma_m, sigma_rad});
  }
}

void EarlierPairs::forget() {
  views_.clear();
  pairs_.clear();
}

void EarlierPairs::look(const DisparityEvidence& matches, const cv::Mat& textured) {
  vanished_ = cv::Mat();
  best_px_ = matches.best_px;
  repeated_px_ = matches.repeated_px;
  textured_ = textured;
}

void EarlierPairs::findVanished() const {
  const cv::Size size = geometry_.size();
  const cv::Size cells((size.width + kCell_px - 1) / kCell_px, (size.height + kCell_px - 1) / kCell_px);
  vanished_ = cv::Mat::zeros(cells, CV_8UC1);
  if (textured_.empty()) return;
  const auto isSeen = [&](int v, int u) {
    const bool is_matched = best_px_.at<float>(v, u) > 0.0f || repeated_px_.at<float>(v, u) > 0.0f;
    return is_matched && textured_.at<std::uint8_t>(v, u) != 0;
  };
  cv::Mat balance(cells, CV_16SC1);  // points that are seen no more, less those that are
  for (const View& view : views_) {
    balance.setTo(0);
    const Eigen::Isometry3d T_C_E = view.T_E_C.inverse();
    const Eigen::Matrix3f turned = (geometry_.cameraMatrix() * T_C_E.linear()).cast<float>();
    const Eigen::Vector3f moved = (geometry_.cameraMatrix() * T_C_E.translation()).cast<float>();
    for (const Eigen::Vector3f& p_E : view.pair->surface_C) {
      const Eigen::Vector3f p = turned * p_E + moved;
      const float u = p.x() / p.z() + 0.5f, v = p.y() / p.z() + 0.5f;
      if (!(p.z() > 0.0f && u >= 0.0f && v >= 0.0f && u < size.width && v < size.height)) continue;
      const auto column = static_cast<int>(u), row = static_cast<int>(v);
      balance.at<std::int16_t>(row / kCell_px, column / kCell_px) += isSeen(row, column) ? -1 : 1;
    }
    vanished_ |= balance >= kVanished;
  }
}

EarlierPairs::Plane EarlierPairs::plane(double depth_m) const {
  Plane plane;
  plane.focal_baseline_px_m_ = static_cast<float>(geometry_.disparity(1.0));
  plane.shift_px_ = static_cast<float>(geometry_.principalPointDifference());
  plane.focal_px_ = static_cast<float>(geometry_.calibration().fx_px);
  const auto seen = [&](const View& view, int u, int v) {
    return Eigen::Vector3d(geometry_.cameraMatrix() * (view.T_E_C * geometry_.point(u, v, depth_m)));
  };
  for (const View& view : views_) {
    const double error_m = std::hypot(view.sigma_m, view.sigma_rad * depth_m);
    if (!(error_m <= kMost_m)) continue;
    const Eigen::Vector3d corner = seen(view, 0, 0);
    plane.views_.push_back({&view.pair->met_left_px, &view.pair->met_right_px, corner.cast<float>(),
                            (seen(view, 1, 0) - corner).cast<float>(), (seen(view, 0, 1) - corner).cast<float>(),
                            static_cast<float>(error_m)});
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
    const int reach = cvRound(focal_px_ * view.error_m / p.z());
    const int column = cvRound(p.x() / p.z()), row = cvRound(p.y() / p.z());
    const auto isClear = [&](const cv::Mat& met_px, int at) {
      if (at < reach || row < reach || at >= met_px.cols - reach || row >= met_px.rows - reach) return false;
      const auto* line = met_px.ptr<float>(row);
      return line[at] < at_px && line[at - reach] < at_px && line[at + reach] < at_px &&
             met_px.at<float>(row - reach, at) < at_px && met_px.at<float>(row + reach, at) < at_px;
    };
    const int at_right = column - cvRound(focal_baseline_px_m_ / p.z() + shift_px_);
    if ((isClear(*view.left, column) || isClear(*view.right, at_right)) && ++votes >= kVotes) return true;
  }
  return false;
}

}  // namespace flight_corridor
