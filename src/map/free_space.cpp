#include "flight_corridor/map/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <opencv2/core/utility.hpp>

#include "flight_corridor/map/wide_registers.hpp"

namespace flight_corridor {

namespace {

constexpr float kSmallestDepth_m = 0.05f;  // cubes nearer than this may reach behind the camera's optical centre
constexpr double kSeenTile = 0.5;          // share of a tile's pixels that must have a ray
constexpr unsigned kAllChildren = 0xFF;
constexpr std::size_t kMostInnerCubes = 1 + 8 + 64 + 512;  // of a block: its cubes that are no cells

/// Tile of a pixel's column or row, moved into the image.
int tileAt(float px, float last_px) {
  const float positive = px > 0.0f ? px : 0.0f;
  return static_cast<int>(positive < last_px ? positive : last_px) / DepthPyramid::kTile_px;
}

}  // namespace

/// The eight parts of a cube, side by side so that the compiler vectorises over them. Each is bounded by a box
/// square to the camera, whose image is bounded by its sides at its nearest or farthest depth.
struct FreeSpace::Parts {
  float x_m[8], y_m[8], z_m[8];    // centres in C
  float near_m[8], far_m[8];       // depths of the box
  DepthPyramid::EightTiles tiles;  // of its image
  int is_inside[8];                // the image, wholly
  int is_near[8];                  // in part too near to be shown free
  int is_seen[8];                  // perhaps, by rays that are free in it
  float nearest_m[8];              // the least free ray that meets it
  int unusable[8];                 // tiles of the image
  unsigned near = 0, seen = 0;     // bit i: is_near[i], is_seen[i]
  unsigned free = 0;               // bit i: it is
};

FreeSpace::FreeSpace(const MapConfig& config, const StereoGeometry& geometry, double nearest_m)
    : config_(config), geometry_(geometry), nearest_m_(std::max(static_cast<float>(nearest_m), kSmallestDepth_m)) {
  const cv::Size size = geometry.size();
  const Eigen::Vector3d corners_C[] = {geometry.point(0, 0, 1), geometry.point(size.width - 1, 0, 1),
                                       geometry.point(size.width - 1, size.height - 1, 1),
                                       geometry.point(0, size.height - 1, 1)};
  for (int side = 0; side < 4; ++side) {
    view_sides_C_[side] = corners_C[(side + 1) % 4].cross(corners_C[side]).cast<float>();
  }
}

/// First down to blocks, then below each of them, side by side on as many threads as OpenCV has.
const std::vector<FreeSpace::FreeCubes>& FreeSpace::find(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C) {
  const Eigen::Isometry3f T_C_M = T_M_C.inverse().cast<float>();
  orientCubes(T_C_M);
  pyramid_.build(depth_m, geometry_, config_.free_band_px, kSeenTile);
  for (FreeCubes& cubes : free_) cubes.clear();
  blocks_.clear();
  const Cube root{octomap::OcTreeKey(0, 0, 0), 0, T_C_M.translation(), std::numeric_limits<float>::infinity()};
  findBelow(root, free_[0], &blocks_);
  while (free_.size() <= blocks_.size()) free_.emplace_back().reserve(kMostInnerCubes);
  cv::parallel_for_({0, static_cast<int>(blocks_.size())}, [this](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) findBelow(blocks_[i], free_[i + 1], nullptr);
  });
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

void FreeSpace::findBelow(const Cube& cube, FreeCubes& free, std::vector<Cube>* blocks) const {
  if (const unsigned children = descend(cube, free, blocks)) free.push_back({cube.key, cube.depth, children});
}

/// @return the free children of a cube; free cubes below the others are noted.
/// @param blocks takes those to be descended into later; null: none.
unsigned FreeSpace::descend(const Cube& cube, FreeCubes& free, std::vector<Cube>* blocks) const {
  const unsigned depth = cube.depth + 1;
  Parts parts;
  project(cube, parts);
  const int least_tiles = leastTilesOfCells(cube);
  const bool are_cells = depth == EvidenceTree::kDepth;
  compareWithRays(are_cells ? 0 : least_tiles * least_tiles, parts);
  unsigned children = parts.free;
  if (are_cells) return children;
  for (unsigned rest = (parts.seen & ~children) | parts.near; rest != 0; rest &= rest - 1) {
    const unsigned i = __builtin_ctz(rest);
    const bool is_near = parts.is_near[i] != 0;
    const float farthest_m = is_near ? cube.farthest_m : pyramid_.farthest(parts.tiles[i], least_tiles);
    if (parts.near_m[i] + cellDepth() > farthest_m || (is_near && isBesideView(parts, i, depth))) continue;
    const Cube part{
        EvidenceTree::childKey(cube.key, cube.depth, i), depth, {parts.x_m[i], parts.y_m[i], parts.z_m[i]}, farthest_m};
    if (blocks && depth == kBlockDepth) {
      blocks->push_back(part);
      continue;
    }
    const unsigned below = descend(part, free, blocks);
    if (below == kAllChildren) {
      children |= 1u << i;
    } else if (below != 0) {
      free.push_back({part.key, depth, below});
    }
  }
  return children;
}

/// Finds those parts before the ends of all their rays in which every cell has rays enough: a cell's image holds no
/// more tiles without than its cube's, and no fewer tiles than the smallest image of a cell.
/// @param least_tiles of a cell's image; 0: the parts are cells.
FLIGHT_CORRIDOR_WIDE void FreeSpace::compareWithRays(int least_tiles, Parts& parts) const {
  pyramid_.nearest(parts.tiles, parts.nearest_m);
  pyramid_.unusable(parts.tiles, parts.unusable);
  const auto max_range_m = static_cast<float>(config_.max_range_m);
  const auto unusable_share = static_cast<float>(1.0 - config_.min_ray_fraction);
  for (int i = 0; i < 8; ++i) {
    const int tiles = least_tiles > 0 ? least_tiles : parts.tiles.area(i);
    const unsigned is_free = parts.is_seen[i] & parts.is_inside[i] & (parts.far_m[i] <= parts.nearest_m[i]) &
                             (parts.far_m[i] <= max_range_m) &
                             (static_cast<float>(parts.unusable[i]) <= unusable_share * static_cast<float>(tiles));
    parts.free |= is_free << i;
  }
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
    const int is_near = parts.near_m[i] < nearest_m_;
    parts.is_near[i] = is_near & (parts.far_m[i] > nearest_m_);
    parts.is_seen[i] = (is_near ^ 1) & (is_outside ^ 1) & (parts.near_m[i] <= nearest_end_m);
    parts.is_inside[i] = (left_px >= 0.0f) & (right_px <= last_u) & (top_px >= 0.0f) & (bottom_px <= last_v);
    parts.near |= static_cast<unsigned>(parts.is_near[i]) << i;
    parts.seen |= static_cast<unsigned>(parts.is_seen[i]) << i;
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
