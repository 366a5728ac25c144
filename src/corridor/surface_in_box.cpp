#include "flight_corridor/corridor/surface_in_box.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace flight_corridor {

namespace {

constexpr double kEdge_px = 4.0;             // so far block matching may move a surface's edge
constexpr double kFartherFromNear_px = 1.0;  // so much farther a surface may turn out to be when it is seen from nearer
constexpr double kUncertainShare = 0.15;     // of a surface's points that may be nearer by noise: about one sigma; of
                                             // a cell's rays that may have no end

}  // namespace

SurfaceInBox::SurfaceInBox(const MapConfig& config, const StereoGeometry& geometry, const cv::Mat& depth_m,
                           double scale_sigma, const Eigen::Isometry3d& T_M_C, const Box& box,
                           std::pmr::memory_resource* memory)
    : min_hit_points_(config.min_hit_points),
      hit_band_px_(config.hit_band_px),
      cell_m_(config.resolution_m),
      geometry_(geometry),
      hit_rule_(config, geometry.calibration()),
      depth_m_(depth_m),
      scale_sigma_(scale_sigma),
      T_M_C_(T_M_C),
      T_F_C_(box.T_M_F.inverse() * T_M_C),
      box_size_m_(box.size_m),
      cell_reach_C_(0.5 * config.resolution_m * T_M_C.linear().cwiseAbs().colwise().sum().transpose()),
      begins_m_(memory) {}

double SurfaceInBox::begin(const Eigen::Vector3d& cell_centre_M, double near_m) {
  const Eigen::Vector3d centre_C = T_M_C_.inverse() * cell_centre_M;
  if (!isShown(centre_C)) return near_m;
  if (static_cast<int>(begins_m_.size()) < min_hit_points_) return kInfinity;
  const auto begin = begins_m_.begin() + static_cast<std::ptrdiff_t>(kUncertainShare * begins_m_.size());
  std::nth_element(begins_m_.begin(), begin, begins_m_.end());
  return std::clamp(*begin, near_m, std::max(near_m, box_size_m_.x()));
}

/// Whether the image shows what is in a cell: points that make a hit; or none in the box, and nearly all rays end in
/// the cell or so little behind it that what was remembered in it is their surface. What is seen far behind it is no
/// such proof: images lose thin obstacles now and then. Collects where the points in the box begin.
bool SurfaceInBox::isShown(const Eigen::Vector3d& centre_C) {
  const cv::Rect area = pixels(centre_C);
  const Eigen::Matrix3d& R_M_C = T_M_C_.linear();
  const Eigen::Vector3d centre = R_M_C * centre_C;  // from C's origin, along the cell's edges
  const double far_m = centre_C.z() + cell_reach_C_.z();
  int rays = 0, hits = 0, behind = 0;
  begins_m_.clear();
  for (int v = area.y; v < area.br().y; ++v) {
    for (int u = area.x; u < area.br().x; ++u) {
      const Eigen::Vector3d ray_C = geometry_.point(u, v, 1.0), ray = R_M_C * ray_C;
      const double depth_m = depth_m_.at<float>(v, u);
      const double hit_m = geometry_.shiftedDepth(depth_m, hit_band_px_);
      const bool is_hit = isInCell(ray * hit_m - centre), crosses = isInCell(ray * centre_C.z() - centre);
      rays += is_hit || crosses;
      hits += is_hit;
      behind +=
          crosses && !is_hit && hit_m > centre_C.z() && geometry_.shiftedDepth(depth_m, kFartherFromNear_px) <= far_m;
      if (is_hit && isInBox(ray_C * hit_m)) begins_m_.push_back((T_F_C_ * (ray_C * depth_m)).x());
    }
  }
  return hit_rule_.isHit(static_cast<std::uint32_t>(hits), static_cast<float>(centre_C.z())) ||
         (begins_m_.empty() && rays >= min_hit_points_ && hits + behind >= (1.0 - kUncertainShare) * rays);
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

bool SurfaceInBox::isInCell(const Eigen::Vector3d& from_centre) const {
  return (from_centre.cwiseAbs().array() <= 0.5 * cell_m_).all();
}

/// Or so little beside it that its edge may be, or that it would be if the depth's scale is wrong.
bool SurfaceInBox::isInBox(const Eigen::Vector3d& point_C) const {
  const double edge_m = kEdge_px * point_C.z() / geometry_.calibration().fx_px;
  const Eigen::Vector3d point_F = T_F_C_ * point_C;
  const auto is_between_sides = [&](int axis) {
    const double beside_m = std::hypot(edge_m, scale_sigma_ * point_F[axis]);
    return !(std::abs(point_F[axis]) > 0.5 * box_size_m_[axis] + beside_m);  // a scale of unknown sigma dismisses none
  };
  return point_F.x() < box_size_m_.x() && is_between_sides(1) && is_between_sides(2);
}

}  // namespace flight_corridor
