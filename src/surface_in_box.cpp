#include "flight_corridor/surface_in_box.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace flight_corridor {

namespace {

constexpr double kBeside_m = 0.05;     // so far outside of the box's sides a point may lie by error: 4 px at 4 m
constexpr double kNearerShare = 0.15;  // of a surface's points that may be nearer by noise: about one sigma

}  // namespace

SurfaceInBox::SurfaceInBox(const MapConfig& config, const StereoGeometry& geometry, const cv::Mat& depth_m,
                           const Eigen::Isometry3d& T_M_C, const Box& box)
    : config_(config),
      geometry_(geometry),
      depth_m_(depth_m),
      T_M_C_(T_M_C),
      T_F_C_(box.T_M_F.inverse() * T_M_C),
      box_size_m_(box.size_m),
      cell_reach_C_(0.5 * config.resolution_m * T_M_C.linear().cwiseAbs().colwise().sum().transpose()) {}

double SurfaceInBox::begin(const Eigen::Vector3d& cell_centre_M, double near_m) {
  const Eigen::Vector3d cell_centre_C = T_M_C_.inverse() * cell_centre_M;
  const cv::Rect area = pixels(cell_centre_C);
  int points = 0;
  begins_m_.clear();
  for (int v = area.y; v < area.br().y; ++v) {
    for (int u = area.x; u < area.br().x; ++u) {
      const double depth_m = depth_m_.at<float>(v, u);
      const Eigen::Vector3d hit_C = geometry_.point(u, v, geometry_.shiftedDepth(depth_m, config_.hit_band_px));
      const Eigen::Vector3d from_centre_M = T_M_C_.linear() * (hit_C - cell_centre_C);
      if (!(from_centre_M.cwiseAbs().array() <= 0.5 * config_.resolution_m).all()) continue;
      ++points;
      if (isInBox(T_F_C_ * hit_C)) begins_m_.push_back((T_F_C_ * geometry_.point(u, v, depth_m)).x());
    }
  }
  if (!(points >= enoughPoints(cell_centre_C.z()))) return near_m;
  if (static_cast<int>(begins_m_.size()) < config_.min_hit_points) return kInfinity;
  const auto begin = begins_m_.begin() + static_cast<std::ptrdiff_t>(kNearerShare * begins_m_.size());
  std::nth_element(begins_m_.begin(), begin, begins_m_.end());
  return std::clamp(*begin, near_m, std::max(near_m, box_size_m_.x()));
}

/// Pixels of the box square to C around a cell; none where it does not lie wholly on the image.
cv::Rect SurfaceInBox::pixels(const Eigen::Vector3d& cell_centre_C) const {
  Eigen::AlignedBox2d area;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d corner(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
    const Eigen::Vector2d pixel = geometry_.project(cell_centre_C + cell_reach_C_.cwiseProduct(corner));
    if (!geometry_.contains(pixel)) return {};
    area.extend(pixel);
  }
  const Eigen::Vector2i first = area.min().array().floor().cast<int>(), last = area.max().array().floor().cast<int>();
  return {first.x(), first.y(), last.x() - first.x() + 1, last.y() - first.y() + 1};
}

/// Those that make a hit, as in OccupancyMap.
double SurfaceInBox::enoughPoints(double depth_m) const {
  const StereoCalibration& calibration = geometry_.calibration();
  const double edge_m = config_.resolution_m;
  const double face_px = calibration.fx_px * calibration.fy_px * edge_m * edge_m / (depth_m * depth_m);
  return std::max<double>(config_.min_hit_points, config_.hit_fraction * face_px);
}

bool SurfaceInBox::isInBox(const Eigen::Vector3d& point_F) const {
  return point_F.x() < box_size_m_.x() && std::abs(point_F.y()) <= 0.5 * box_size_m_.y() + kBeside_m &&
         std::abs(point_F.z()) <= 0.5 * box_size_m_.z() + kBeside_m;
}

}  // namespace flight_corridor
