#include "flight_corridor/corridor/movers.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "flight_corridor/stereo/match_error.hpp"

namespace flight_corridor {

namespace {

constexpr int kColumns = 160;              // of matches that are looked at, at least
constexpr double kMostDepth_m = 8.0;       // nothing beyond is looked for
constexpr double kWindow_s = 0.8;          // within which a place was clear, and a track moved
constexpr double kSmallest_m2 = 0.02;      // shown of what moves
constexpr std::size_t kSightings = 3;      // in which it moves on
constexpr double kSeenThrough_px = 2.0;    // so much farther is what is matched where it was
constexpr double kFastestMover_mps = 4.0;  // between two sightings of one
constexpr double kOutOfView_s = 2.0;       // it may come back
constexpr double kAge_s = 0.15;            // of a verdict when it is used: a pair's time, and what it takes to judge it
constexpr double kStep_m = 0.05;           // along a box

}  // namespace

void Movers::look(double stamp_s, const std::optional<CameraPose>& pose, const cv::Mat& depth_m,
                  const cv::Mat& textured, const EarlierPairs& earlier) {
  if (stamp_s == stamp_s_) return;
  stamp_s_ = stamp_s;
  has_pose_ = pose.has_value();
  if (pose) {
    if (pose->series != series_) tracks_.clear();
    series_ = pose->series;
    T_V_C_ = pose->T_M_C;
    findArrivals(depth_m, textured, earlier);
    for (const Patch& patch : arrivals_) {
      if (patch.shown_m2 >= kSmallest_m2) follow(patch, depth_m);
    }
  }
  const auto is_lost = [&](const Track& track) { return isLost(track, depth_m); };
  tracks_.erase(std::remove_if(tracks_.begin(), tracks_.end(), is_lost), tracks_.end());
}

/// Patches of matches that stand where it was clear, of one surface each.
void Movers::findArrivals(const cv::Mat& depth_m, const cv::Mat& textured, const EarlierPairs& earlier) {
  arrivals_.clear();
  if (earlier.empty()) return;
  const int stride_px = std::max(1, depth_m.cols / kColumns);
  arrived_.create((depth_m.rows + stride_px - 1) / stride_px, (depth_m.cols + stride_px - 1) / stride_px, CV_8UC1);
  for (int row = 0; row < arrived_.rows; ++row) {
    const int v = row * stride_px;
    const float *depth = depth_m.ptr<float>(v), *above = depth_m.ptr<float>(std::max(0, v - stride_px));
    const auto* is_textured = textured.ptr(v);
    const auto isEdge = [&](int u, float beside_m) {
      return !isOneSurface(geometry_.disparity(depth[u]), geometry_.disparity(beside_m));
    };
    for (int column = 0; column < arrived_.cols; ++column) {
      const int u = column * stride_px;
      const bool is_seen = depth[u] <= kMostDepth_m && is_textured[u];  // NaN is not
      arrived_.at<std::uint8_t>(row, column) = is_seen && !isEdge(u, above[u]) &&
                                               !isEdge(u, depth[std::max(0, u - stride_px)]) &&
                                               earlier.wasClear(geometry_.point(u, v, depth[u]), kWindow_s);
    }
  }
  arrivals_.resize(cv::connectedComponents(arrived_, labels_, 4) - 1);
  for (int row = 0; row < arrived_.rows; ++row) {
    for (int column = 0; column < arrived_.cols; ++column) {
      const int label = labels_.at<int>(row, column);
      if (label == 0) continue;
      const int u = column * stride_px, v = row * stride_px;
      const double at_m = depth_m.at<float>(v, u);
      Patch& patch = arrivals_[label - 1];
      patch.points_C.push_back(geometry_.point(u, v, at_m));
      patch.shown_m2 += std::pow(stride_px * geometry_.pixelEdge(geometry_.disparity(at_m)), 2);
    }
  }
}

/// A patch is the nearest track's that may have come there since, or begins one.
void Movers::follow(const Patch& patch, const cv::Mat& depth_m) {
  const Eigen::Vector3d sum_C =
      std::accumulate(patch.points_C.begin(), patch.points_C.end(), Eigen::Vector3d(0.0, 0.0, 0.0));
  const Eigen::Vector3d centre_C = sum_C / static_cast<double>(patch.points_C.size());
  const Sighting sighting{stamp_s_, T_V_C_ * centre_C};
  const auto distance = [&](const Track& track) {
    const Sighting& last = track.sightings.back();
    const double away_m = (sighting.centre_V - last.centre_V).norm();
    const double since_s = stamp_s_ - last.stamp_s;
    return since_s <= kWindow_s && away_m < kFastestMover_mps * since_s ? away_m : kInfinity;
  };
  auto track = std::min_element(tracks_.begin(), tracks_.end(),
                                [&](const Track& one, const Track& other) { return distance(one) < distance(other); });
  if (track == tracks_.end() || distance(*track) == kInfinity) track = tracks_.insert(tracks_.end(), Track());
  auto& sightings = track->sightings;
  sightings.push_back(sighting);
  while (stamp_s_ - sightings.front().stamp_s > kWindow_s) sightings.pop_front();
  track->points_V.clear();
  for (const Eigen::Vector3d& p_C : patch.points_C) track->points_V.push_back(T_V_C_ * p_C);
  track->moves = track->moves || moves(sightings, depth_m);
}

/// On from each sighting to the next; and where it was at the first, the newest pair sees through. What came into view
/// piece by piece is still there, or hidden.
bool Movers::moves(const std::deque<Sighting>& sightings, const cv::Mat& depth_m) const {
  if (sightings.size() < kSightings) return false;
  const Eigen::Vector3d way_V = sightings.back().centre_V - sightings.front().centre_V;
  for (std::size_t i = 1; i < sightings.size(); ++i) {
    if (way_V.dot(sightings[i].centre_V - sightings[i - 1].centre_V) <= 0.0) return false;
  }
  return seesThrough(sightings.front().centre_V, depth_m);
}

/// Whether what is matched in the view of a place is farther.
bool Movers::seesThrough(const Eigen::Vector3d& p_V, const cv::Mat& depth_m) const {
  const Eigen::Vector3d p_C = T_V_C_.inverse() * p_V;
  const Eigen::Vector2d pixel = geometry_.project(p_C);
  if (!geometry_.contains(pixel)) return false;
  const double now_m = depth_m.at<float>(cvRound(pixel.y()), cvRound(pixel.x()));
  return geometry_.disparity(now_m) < geometry_.disparity(p_C.z()) - kSeenThrough_px;  // NaN is not
}

/// Not seen for a while, and not where it would have gone.
bool Movers::isLost(const Track& track, const cv::Mat& depth_m) const {
  const Sighting &first = track.sightings.front(), &last = track.sightings.back();
  const double since_s = stamp_s_ - last.stamp_s;
  if (since_s <= kWindow_s) return false;
  if (!track.moves || since_s > kOutOfView_s) return true;
  const Eigen::Vector3d way_V = last.centre_V - first.centre_V;
  return has_pose_ && seesThrough(last.centre_V + since_s / (last.stamp_s - first.stamp_s) * way_V, depth_m);
}

double Movers::freeUpTo(const Box& box_C, const SpeedConfig& speed) const {
  const Eigen::Isometry3d T_F_V = (T_V_C_ * box_C.T_M_F).inverse();
  const Eigen::Array2d half_m = 0.5 * box_C.size_m.tail<2>().array();
  double free_m = box_C.size_m.x();
  for (const Track& track : tracks_) {
    if (!track.moves) continue;
    if (!has_pose_) return 0.0;
    const double since_s = stamp_s_ - track.sightings.back().stamp_s;
    for (const Eigen::Vector3d& p_V : track.points_V) {
      const Eigen::Vector3d p_F = T_F_V * p_V;
      const double beside_m = (p_F.tail<2>().array().abs() - half_m).max(0.0).matrix().norm();
      const auto canBeThere = [&] {  // the less free, the sooner it stands
        const double stands_s = timeToStand(safeSpeed(free_m, kAge_s, speed), kAge_s, speed);
        const double along_m = std::max({0.0, -p_F.x(), p_F.x() - free_m});
        return std::hypot(along_m, beside_m) <= speed.mover_mps * (since_s + stands_s);
      };
      while (free_m > 0.0 && canBeThere()) free_m -= kStep_m;
    }
  }
  return free_m < box_C.size_m.x() ? std::max(0.0, free_m) : kInfinity;
}

}  // namespace flight_corridor
