#include "flight_corridor/map/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flight_corridor {

namespace {

constexpr float kSmallestDepth_m = 0.05f;  // cubes nearer than this may reach behind the camera's optical centre
constexpr double kSeenTile = 0.5;          // share of a tile's pixels that must have a ray
constexpr unsigned kAllChildren = 0xFF;

/// Tile of a pixel's column or row, moved into the image.
int tileAt(float px, int size_px) {
  return static_cast<int>(std::clamp(px, 0.0f, static_cast<float>(size_px - 1))) / DepthPyramid::kTile_px;
}

}  // namespace

FreeSpace::FreeSpace(const MapConfig& config, const StereoGeometry& geometry, double nearest_m)
    : config_(config), geometry_(geometry), nearest_m_(std::max(static_cast<float>(nearest_m), kSmallestDepth_m)) {}

const std::vector<FreeSpace::Cube>& FreeSpace::find(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C) {
  const Eigen::Isometry3f T_C_M = T_M_C.inverse().cast<float>();
  for (unsigned depth = 0; depth <= EvidenceTree::kDepth; ++depth) {
    const double edge_m = std::ldexp(config_.resolution_m, static_cast<int>(EvidenceTree::kDepth - depth));
    half_edges_C_[depth] = T_C_M.linear() * static_cast<float>(0.5 * edge_m);
    reach_[depth] = half_edges_C_[depth].cwiseAbs().rowwise().sum();
  }
  pyramid_.build(depth_m, geometry_, config_.free_band_px, kSeenTile);
  free_.clear();
  const Cube root{octomap::OcTreeKey(0, 0, 0), 0};
  if (findIn(root, T_C_M.translation())) free_.push_back(root);
  return free_;
}

/// A cube is free before the ends of all its rays where every cell has rays enough: a cell's image holds no more tiles
/// without than its cube's, and no fewer tiles than the smallest image of a cell.
/// @return whether all of a cube is free; otherwise free cubes in it are noted.
bool FreeSpace::findIn(const Cube& cube, const Eigen::Vector3f& centre_C) {
  const Eigen::Vector3f& reach = reach_[cube.depth];
  const float near_m = centre_C.z() - reach.z(), far_m = centre_C.z() + reach.z();
  const auto max_range_m = static_cast<float>(config_.max_range_m);
  if (far_m <= nearest_m_ || near_m > max_range_m) return false;
  const Area area = project(centre_C, reach);
  const auto last_u = static_cast<float>(geometry_.size().width - 1);
  const auto last_v = static_cast<float>(geometry_.size().height - 1);
  if (area.right < 0.0f || area.left > last_u || area.bottom < 0.0f || area.top > last_v) return false;
  const bool is_cell = cube.depth == EvidenceTree::kDepth;
  if (near_m >= nearest_m_) {
    const cv::Rect tiles = tilesOf(area);
    const bool is_inside = area.left >= 0.0f && area.right <= last_u && area.top >= 0.0f && area.bottom <= last_v;
    if (is_inside && far_m <= max_range_m && far_m <= pyramid_.nearest(tiles)) {
      const double most_unusable =
          (1.0 - config_.min_ray_fraction) * (is_cell ? tiles.area() : leastTilesOfCells(far_m));
      if (pyramid_.unusable(tiles) <= most_unusable) return true;
    }
    if (is_cell || near_m + 2.0f * reachOfCells().z() > pyramid_.farthest(tiles)) return false;
  }
  return !is_cell && findInChildren(cube, centre_C);
}

bool FreeSpace::findInChildren(const Cube& cube, const Eigen::Vector3f& centre_C) {
  const Eigen::Matrix3f& half_edges_C = half_edges_C_[cube.depth];
  unsigned free = 0;
  for (unsigned i = 0; i < 8; ++i) {
    const Eigen::Vector3f place(i & 1 ? 0.5f : -0.5f, i & 2 ? 0.5f : -0.5f, i & 4 ? 0.5f : -0.5f);
    const Cube child{EvidenceTree::childKey(cube.key, cube.depth, i), cube.depth + 1};
    free |= static_cast<unsigned>(findIn(child, centre_C + half_edges_C * place)) << i;
  }
  if (free == kAllChildren) return true;
  for (unsigned i = 0; i < 8; ++i) {
    if (free >> i & 1u) free_.push_back({EvidenceTree::childKey(cube.key, cube.depth, i), cube.depth + 1});
  }
  return false;
}

/// Bounds of the image of a box square to C: each by its side at its nearest or farthest depth. A side that widens
/// towards the camera is unbounded where the box begins behind it.
FreeSpace::Area FreeSpace::project(const Eigen::Vector3f& centre_C, const Eigen::Vector3f& reach) const {
  const float near_m = centre_C.z() - reach.z();
  const float per_near = near_m > 0.0f ? 1.0f / near_m : std::numeric_limits<float>::infinity();
  const float per_far = 1.0f / (centre_C.z() + reach.z());
  const auto low = [&](float side_m) { return side_m * (side_m < 0.0f ? per_near : per_far); };
  const auto high = [&](float side_m) { return side_m * (side_m > 0.0f ? per_near : per_far); };
  const StereoCalibration& calibration = geometry_.calibration();
  const auto fx = static_cast<float>(calibration.fx_px), cx = static_cast<float>(calibration.cx_px);
  const auto fy = static_cast<float>(calibration.fy_px), cy = static_cast<float>(calibration.cy_px);
  return {low(centre_C.x() - reach.x()) * fx + cx, low(centre_C.y() - reach.y()) * fy + cy,
          high(centre_C.x() + reach.x()) * fx + cx, high(centre_C.y() + reach.y()) * fy + cy};
}

/// With the pixels on either side of a border.
cv::Rect FreeSpace::tilesOf(const Area& area) const {
  const cv::Size size = geometry_.size();
  const cv::Point first(tileAt(area.left, size.width), tileAt(area.top, size.height));
  const cv::Point last(tileAt(area.right + 1.0f, size.width), tileAt(area.bottom + 1.0f, size.height));
  return {first, last + cv::Point(1, 1)};
}

/// How many tiles the image of a cell holds at least, up to a depth.
int FreeSpace::leastTilesOfCells(float far_m) const {
  const StereoCalibration& calibration = geometry_.calibration();
  const float size_px = 2.0f / far_m *
                        std::min(static_cast<float>(calibration.fx_px) * reachOfCells().x(),
                                 static_cast<float>(calibration.fy_px) * reachOfCells().y());
  const int side = 1 + static_cast<int>(size_px + 0.99f) / DepthPyramid::kTile_px;
  return side * side;
}

}  // namespace flight_corridor
