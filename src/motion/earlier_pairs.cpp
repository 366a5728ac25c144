#include "flight_corridor/motion/earlier_pairs.hpp"

#include <cmath>
#include <opencv2/core.hpp>
#include <utility>

#include "flight_corridor/stereo/match_error.hpp"

namespace flight_corridor {

namespace {

constexpr std::size_t kMostPairs = 16;  // 1.6 s of them, at least
constexpr int kVotes = 2;               // earlier pairs that must have seen a place clear
constexpr double kSurely = 3.0;         // sigmas of the motion: the place was clear beyond doubt
constexpr double kMatchError_px = 1.0;  // of both matches there
constexpr double kNearest_m = 0.1;      // of places that are asked about
constexpr int kAsked = 4;               // of the oldest pairs: what came later, too, is not there yet
constexpr int kClear = 5;               // of nine rays around a place; the others may be unknown
constexpr int kStride_px = 8;           // between the matches of a pair that are kept
constexpr int kVanished = 3;            // points of a square, of four, that are seen no more: at its edge others are

}  // namespace

EarlierPairs::EarlierPairs(const StereoGeometry& geometry) : geometry_(geometry), pairs_(kMostPairs) {}

void EarlierPairs::add(double stamp_s, const CameraPose& pose, const cv::Mat& depth_m, const cv::Mat& textured,
                       cv::Mat& met_left_px, cv::Mat& met_right_px) {
  Kept* kept = pairs_.add(stamp_s, pose);
  if (!kept) return;
  kept->met_left_px.create(met_left_px.size(), met_left_px.type());
  kept->met_right_px.create(met_right_px.size(), met_right_px.type());
  std::swap(kept->met_left_px, met_left_px);
  std::swap(kept->met_right_px, met_right_px);
  kept->surface_C.clear();
  for (int v = kStride_px / 2; v < depth_m.rows; v += kStride_px) {
    for (int u = kStride_px / 2; u < depth_m.cols; u += kStride_px) {
      const float at_m = depth_m.at<float>(v, u);
      if (at_m > 0.0f && textured.at<std::uint8_t>(v, u)) {
        kept->surface_C.push_back(geometry_.point(u, v, at_m).cast<float>());
      }
    }
  }
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
  for (const Ring::View& view : pairs_.views()) {
    balance.setTo(0);
    const Eigen::Isometry3d T_C_E = view.motion.T_K_C.inverse();
    const Eigen::Matrix3f turned = (geometry_.cameraMatrix() * T_C_E.linear()).cast<float>();
    const Eigen::Vector3f moved = (geometry_.cameraMatrix() * T_C_E.translation()).cast<float>();
    for (const Eigen::Vector3f& p_E : view.kept->surface_C) {
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
  const auto seen = [&](const Ring::View& view, int u, int v) {
    return Eigen::Vector3d(geometry_.cameraMatrix() * (view.motion.T_K_C * geometry_.point(u, v, depth_m)));
  };
  for (const Ring::View& view : pairs_.views()) {
    const double error_m = view.motion.error(depth_m);
    if (!(error_m <= kMostError_m)) continue;
    const Eigen::Vector3d corner = seen(view, 0, 0);
    plane.views_.push_back({&view.kept->met_left_px, &view.kept->met_right_px, corner.cast<float>(),
                            (seen(view, 1, 0) - corner).cast<float>(), (seen(view, 0, 1) - corner).cast<float>(),
                            static_cast<float>(error_m)});
  }
  return plane;
}

/// Along an edge matches of the one surface show the other: a place beside one is not certain.
bool EarlierPairs::wasClear(const Eigen::Vector3d& p_C, double oldest_s) const {
  int votes = 0, asked = 0;
  for (auto at = pairs_.views().rbegin(); at != pairs_.views().rend() && asked < kAsked; ++at) {  // the oldest first
    const Ring::View& view = *at;
    if (view.age_s > oldest_s) continue;
    if (votes + kAsked - asked++ < kVotes) return false;
    const Eigen::Vector3d p_E = view.motion.T_K_C * p_C;
    if (!(p_E.z() > kNearest_m)) continue;
    const double error_m = kSurely * view.motion.error(p_E.z());
    const Eigen::Vector2d pixel = geometry_.project(p_E);
    const double reach_px = 0.5 * kEdgeWidth_px + geometry_.calibration().fx_px * error_m / p_E.z();
    if (!geometry_.contains(pixel) || !(reach_px < geometry_.size().width)) continue;
    const int reach = cvCeil(reach_px);
    const cv::Rect around(cvRound(pixel.x()) - reach, cvRound(pixel.y()) - reach, 2 * reach + 1, 2 * reach + 1);
    const cv::Mat& met_px = view.kept->met_left_px;
    if ((around & cv::Rect({0, 0}, met_px.size())) != around) continue;
    const double beyond_px = geometry_.disparity(p_E.z() + error_m) - kMatchError_px;
    const float centre_px = met_px.at<float>(around.y + reach, around.x + reach);
    if (std::isfinite(centre_px) && centre_px >= beyond_px) continue;  // most places: looked at first, to save time
    int clear = 0, not_clear = 0;
    for (const int v : {around.y, around.y + reach, around.y + 2 * reach}) {
      for (const int u : {around.x, around.x + reach, around.x + 2 * reach}) {
        const float ray_px = met_px.at<float>(v, u);
        clear += ray_px < beyond_px;
        not_clear += ray_px >= beyond_px && std::isfinite(ray_px);
      }
    }
    if (not_clear == 0 && clear >= kClear && ++votes >= kVotes) return true;
  }
  return false;
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
