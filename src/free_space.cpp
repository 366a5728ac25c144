#include "flight_corridor/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "flight_corridor/wide_registers.hpp"

namespace flight_corridor {

namespace {

constexpr float kSmallestDepth_m = 0.05f;  // cubes nearer than this reach behind the camera's optical centre
constexpr unsigned kAllChildren = 0xFF;

/// Tile of a pixel's column or row, moved into the image.
int tileAt(float px, float last_px) {
  const float positive = px > 0.0f ? px : 0.0f;
  return static_cast<int>(positive < last_px ? positive : last_px) / DepthPyramid::kTile_px;
}

/// Bit i: flag i.
unsigned bits(const int (&flags)[8]) {
  unsigned all = 0;
  for (unsigned i = 0; i < 8; ++i) all |= static_cast<unsigned>(flags[i]) << i;
  return all;
}

}  // namespace

/// A cube of the octree, known to it or not.
struct FreeSpace::Cube {
  octomap::OcTreeKey key;    // of its lowest corner's cell
  unsigned depth;            // 0 = root
  Eigen::Vector3f centre_C;  // [m]
  float farthest_m;          // up to where one of its rays is free
};

/// The eight parts of a cube, side by side so that the compiler reckons several at once. Each is bounded by a box
/// square to the camera, whose image is bounded by its sides at its nearest or farthest depth.
struct FreeSpace::Parts {
  float x_m[8], y_m[8], z_m[8];    // centres in C
  float near_m[8], far_m[8];       // depths of the box
  DepthPyramid::EightTiles tiles;  // of its image
  int is_inside[8];                // the image, wholly
  int is_near[8];                  // the camera: cannot be projected
  int is_seen[8];                  // perhaps, by rays that are free in it
  float nearest_m[8];              // the least free ray that meets it
  int is_before[8];                // the ends of all rays that meet it
};

FreeSpace::FreeSpace(const MapConfig& config, const StereoGeometry& geometry) : config_(config), geometry_(geometry) {
  const cv::Size size = geometry.size();
  const Eigen::Vector3d corners_C[] = {geometry.point(0, 0, 1), geometry.point(size.width - 1, 0, 1),
                                       geometry.point(size.width - 1, size.height - 1, 1),
                                       geometry.point(0, size.height - 1, 1)};
  for (int side = 0; side < 4; ++side) {
    view_sides_C_[side] = corners_C[(side + 1) % 4].cross(corners_C[side]).cast<float>();
  }
}

const std::vector<FreeSpace::Family>& FreeSpace::find(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C) {
  const Eigen::Isometry3f T_C_M = T_M_C.inverse().cast<float>();
  orientCubes(T_C_M);
  pyramid_.build(depth_m, geometry_, config_.free_band_px, config_.min_ray_fraction);
  free_.clear();
  const Cube root{octomap::OcTreeKey(0, 0, 0), 0, T_C_M.translation(), std::numeric_limits<float>::infinity()};
  if (const unsigned free = descend(root)) free_.push_back({root.key, 0, free});
  return free_;
}

void FreeSpace::orientCubes(const Eigen::Isometry3f& T_C_M) {
  for (unsigned depth = 0; depth <= EvidenceTree::kDepth; ++depth) {
    const double edge_m = std::ldexp(config_.resolution_m, static_cast<int>(EvidenceTree::kDepth - depth));
    const Eigen::Matrix3f half_edges = T_C_M.linear() * static_cast<float>(0.5 * edge_m);
    Orientation& cubes = orientations_[depth];
    cubes.reach = half_edges.cwiseAbs().rowwise().sum();
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3f corner(i & 1 ? 0.5f : -0.5f, i & 2 ? 0.5f : -0.5f, i & 4 ? 0.5f : -0.5f);
      const Eigen::Vector3f part = half_edges * corner;
      cubes.x_m[i] = part.x();
      cubes.y_m[i] = part.y();
      cubes.z_m[i] = part.z();
    }
  }
}

/// @return the free children of a cube; free cubes below the others are noted.
unsigned FreeSpace::descend(const Cube& cube) {
  const unsigned depth = cube.depth + 1;
  Parts parts;
  project(cube, parts);
  compareWithRays(parts);
  const int least_tiles = leastTilesOfCells(cube);
  const bool are_cells = depth == EvidenceTree::kDepth;
  unsigned free = withRaysEnough(parts, are_cells ? 0 : least_tiles * least_tiles);
  if (are_cells) return free;
  for (unsigned rest = (bits(parts.is_seen) & ~free) | bits(parts.is_near); rest != 0; rest &= rest - 1) {
    const unsigned i = __builtin_ctz(rest);
    const bool is_near = parts.is_near[i] != 0;
    const float farthest_m = is_near ? cube.farthest_m : pyramid_.farthest(parts.tiles[i], least_tiles);
    if (parts.near_m[i] + cellDepth() > farthest_m || (is_near && isBesideView(parts, i, depth))) continue;
    const Cube part{
        EvidenceTree::childKey(cube.key, cube.depth, i), depth, {parts.x_m[i], parts.y_m[i], parts.z_m[i]}, farthest_m};
    const unsigned below = descend(part);
    if (below == kAllChildren) {
      free |= 1u << i;
    } else if (below != 0) {
      free_.push_back({part.key, depth, below});
    }
  }
  return free;
}

FLIGHT_CORRIDOR_WIDE void FreeSpace::compareWithRays(Parts& parts) const {
  pyramid_.nearest(parts.tiles, parts.nearest_m);
  const auto max_range_m = static_cast<float>(config_.max_range_m);
  for (int i = 0; i < 8; ++i) {
    parts.is_before[i] = parts.is_seen[i] & parts.is_inside[i] & (parts.far_m[i] <= parts.nearest_m[i]) &
                         (parts.far_m[i] <= max_range_m);
  }
}

/// Those parts before the ends of all their rays in which every cell has rays enough: a cell's image holds no more
/// tiles without than its cube's, and no fewer tiles than the smallest image of a cell.
/// @param least_tiles of a cell's image; 0: the parts are cells.
unsigned FreeSpace::withRaysEnough(const Parts& parts, int least_tiles) const {
  const double unusable_share = 1.0 - config_.min_ray_fraction;
  unsigned enough = 0;
  for (unsigned rest = bits(parts.is_before); rest != 0; rest &= rest - 1) {
    const unsigned i = __builtin_ctz(rest);
    const DepthPyramid::Tiles tiles = parts.tiles[i];
    const double most_unusable = unusable_share * (least_tiles > 0 ? least_tiles : tiles.area());
    enough |= static_cast<unsigned>(pyramid_.unusable(tiles) <= most_unusable) << i;
  }
  return enough;
}

/// How many tiles wide and high a cell's image is at least, anywhere in a cube.
int FreeSpace::leastTilesOfCells(const Cube& cube) const {
  const float far_m = cube.centre_C.z() + orientations_[cube.depth].reach.z();
  const Eigen::Vector3f& reach = orientations_.back().reach;
  const StereoCalibration& calibration = geometry_.calibration();
  const float size_px_m = 2.0f * std::min(static_cast<float>(calibration.fx_px) * reach.x(),
                                          static_cast<float>(calibration.fy_px) * reach.y());
  const float size_px = size_px_m / std::max(far_m, kSmallestDepth_m);
  return 1 + static_cast<int>(size_px + 0.99f) / DepthPyramid::kTile_px;
}

FLIGHT_CORRIDOR_WIDE void FreeSpace::project(const Cube& cube, Parts& parts) const {
  const Orientation& cubes = orientations_[cube.depth];
  const Eigen::Vector3f& reach = orientations_[cube.depth + 1].reach;
  const float reach_x_m = reach.x(), reach_y_m = reach.y(), reach_z_m = reach.z();
  const float x_m = cube.centre_C.x(), y_m = cube.centre_C.y(), z_m = cube.centre_C.z();
  const StereoCalibration& calibration = geometry_.calibration();
  const float fx = static_cast<float>(calibration.fx_px), fy = static_cast<float>(calibration.fy_px);
  const float cx = static_cast<float>(calibration.cx_px), cy = static_cast<float>(calibration.cy_px);
  const float last_u = static_cast<float>(geometry_.size().width - 1);
  const float last_v = static_cast<float>(geometry_.size().height - 1);
  const float nearest_end_m = std::min(static_cast<float>(config_.max_range_m), cube.farthest_m - cellDepth());
  for (int i = 0; i < 8; ++i) {
    parts.x_m[i] = x_m + cubes.x_m[i];
    parts.y_m[i] = y_m + cubes.y_m[i];
    parts.z_m[i] = z_m + cubes.z_m[i];
    parts.near_m[i] = parts.z_m[i] - reach_z_m;
    parts.far_m[i] = parts.z_m[i] + reach_z_m;
    const float per_near = 1.0f / parts.near_m[i], per_far = 1.0f / parts.far_m[i];
    const float left_m = parts.x_m[i] - reach_x_m, right_m = parts.x_m[i] + reach_x_m;
    const float top_m = parts.y_m[i] - reach_y_m, bottom_m = parts.y_m[i] + reach_y_m;
    const float left_px = left_m * (left_m < 0.0f ? per_near : per_far) * fx + cx;
    const float right_px = right_m * (right_m > 0.0f ? per_near : per_far) * fx + cx;
    const float top_px = top_m * (top_m < 0.0f ? per_near : per_far) * fy + cy;
    const float bottom_px = bottom_m * (bottom_m > 0.0f ? per_near : per_far) * fy + cy;
    const int is_outside = (right_px < 0.0f) | (left_px > last_u) | (bottom_px < 0.0f) | (top_px > last_v);
    const int is_near = parts.near_m[i] < kSmallestDepth_m;
    parts.is_near[i] = is_near & (parts.far_m[i] > 0.0f);
    parts.is_seen[i] = (is_near ^ 1) & (is_outside ^ 1) & (parts.near_m[i] <= nearest_end_m);
    parts.is_inside[i] = (left_px >= 0.0f) & (right_px <= last_u) & (top_px >= 0.0f) & (bottom_px <= last_v);
    parts.tiles.left[i] = -parts.is_seen[i] & tileAt(left_px, last_u);
    parts.tiles.right[i] = -parts.is_seen[i] & tileAt(right_px + 1.0f, last_u);
    parts.tiles.top[i] = -parts.is_seen[i] & tileAt(top_px, last_v);
    parts.tiles.bottom[i] = -parts.is_seen[i] & tileAt(bottom_px + 1.0f, last_v);
  }
}

/// Whether a part lies outside one of the planes through the image's borders: for those too near to be projected.
bool FreeSpace::isBesideView(const Parts& parts, unsigned i, unsigned depth) const {
  const Eigen::Vector3f centre_C(parts.x_m[i], parts.y_m[i], parts.z_m[i]);
  return std::any_of(view_sides_C_.begin(), view_sides_C_.end(), [&](const Eigen::Vector3f& normal_C) {
    return normal_C.dot(centre_C) > normal_C.cwiseAbs().dot(orientations_[depth].reach);
  });
}

}  // namespace flight_corridor
