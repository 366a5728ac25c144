#include "flight_corridor/occupancy_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "flight_corridor/types.hpp"

// Before a function of plain loops: built for wide registers too, chosen at run time by what the processor has.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define FLIGHT_CORRIDOR_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define FLIGHT_CORRIDOR_WIDE
#endif

namespace flight_corridor {

namespace {

constexpr int kKeyOrigin = 32768;  // OctoMap's key of the coordinate 0
constexpr int kLastKey = 65535;
constexpr float kSmallestDepth_m = 0.05f;  // cubes nearer than this reach behind the camera's optical centre
constexpr unsigned kWindowBits = 10;       // of a cell's place on one axis of the window around the camera
constexpr int kWindowCells = 1 << kWindowBits;
constexpr std::uint32_t kNoCell = ~std::uint32_t{0};
constexpr std::uint32_t kParent = ~(1u | 1u << kWindowBits | 1u << 2 * kWindowBits);  // of a cell: its parent's lowest
constexpr unsigned kBlockLevels = 4;  // blocks of 16 x 16 x 16 cells are forgotten together
constexpr unsigned kBlockCells = 1u << kBlockLevels;
constexpr unsigned kAllChildren = 0xFF;
constexpr std::uint64_t kNoBlock = ~std::uint64_t{0};

std::uint64_t packed(std::uint64_t x, std::uint64_t y, std::uint64_t z) { return x | y << 16 | z << 32; }
std::uint64_t packed(const octomap::OcTreeKey& key) { return packed(key[0], key[1], key[2]); }

octomap::OcTreeKey unpacked(std::uint64_t cell) {
  return octomap::OcTreeKey(static_cast<octomap::key_type>(cell), static_cast<octomap::key_type>(cell >> 16),
                            static_cast<octomap::key_type>(cell >> 32));
}

octomap::point3d toOctomap(const Eigen::Vector3d& p) {
  return octomap::point3d(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
}

/// Tile of a pixel's column or row, moved into the image.
int tileAt(float px, float last_px) {
  const float positive = px > 0.0f ? px : 0.0f;
  return static_cast<int>(positive < last_px ? positive : last_px) / DepthPyramid::kTile_px;
}

/// x, y, z of a cell of the window.
Eigen::Array3i placeInWindow(std::uint32_t cell) {
  const auto part = [&](unsigned axis) { return static_cast<int>(cell >> (kWindowBits * axis) & (kWindowCells - 1)); };
  return {part(0), part(1), part(2)};
}

/// Which child of its parent a cell of the window is.
unsigned childOfParent(std::uint32_t cell) {
  return (cell & 1u) | (cell >> (kWindowBits - 1) & 2u) | (cell >> (2 * kWindowBits - 2) & 4u);
}

/// Bit i: flag i.
unsigned bits(const int (&flags)[8]) {
  unsigned all = 0;
  for (unsigned i = 0; i < 8; ++i) all |= static_cast<unsigned>(flags[i]) << i;
  return all;
}

}  // namespace

/// A cube of the octree, known to it or not.
struct OccupancyMap::Cube {
  octomap::OcTreeKey key;    // of its lowest corner's cell
  unsigned depth;            // 0 = root
  Eigen::Vector3f centre_C;  // [m]
  float farthest_m;          // up to where one of its rays is free
};

/// The eight parts of a cube, side by side so that the compiler reckons several at once. Each is bounded by a box
/// square to the camera, whose image is bounded by its sides at its nearest or farthest depth.
struct OccupancyMap::Parts {
  float x_m[8], y_m[8], z_m[8];              // centres in C
  float near_m[8], far_m[8];                 // depths of the box
  int left[8], top[8], right[8], bottom[8];  // tiles of its image
  int is_inside[8];                          // the image, wholly
  int is_near[8];                            // the camera: cannot be projected
  int is_seen[8];                            // perhaps, by rays that are free in it

  DepthPyramid::Tiles tiles(unsigned i) const { return {left[i], top[i], right[i], bottom[i]}; }
};

Violations check(const MapConfig& config) {
  Rules rules("map");
  rules.require(0.01 <= config.resolution_m && config.resolution_m <= 1.0, "resolution_m", "0.01 to 1",
                config.resolution_m);
  rules.require(config.max_range_m > config.resolution_m && config.max_range_m <= 100.0, "max_range_m",
                "above resolution_m, up to 100", config.max_range_m);
  rules.require(0.0 < config.hit_fraction && config.hit_fraction <= 1.0, "hit_fraction", "above 0, up to 1",
                config.hit_fraction);
  rules.require(config.min_hit_points >= 1, "min_hit_points", "1 or more", config.min_hit_points);
  rules.require(0.0 <= config.hit_band_px && config.hit_band_px <= config.free_band_px, "hit_band_px",
                "0 to free_band_px", config.hit_band_px);
  rules.require(config.free_band_px >= 0.0, "free_band_px", "not negative", config.free_band_px);
  rules.require(0.0 < config.min_ray_fraction && config.min_ray_fraction <= 1.0, "min_ray_fraction", "above 0, up to 1",
                config.min_ray_fraction);
  rules.require(config.log_odds_hit > 0.0, "log_odds_hit", "positive", config.log_odds_hit);
  rules.require(config.log_odds_miss < 0.0, "log_odds_miss", "negative", config.log_odds_miss);
  rules.require(config.log_odds_min < 0.0 && config.log_odds_min >= -10.0, "log_odds_min", "-10 to below 0",
                config.log_odds_min);
  rules.require(config.log_odds_max > 0.0 && config.log_odds_max <= 10.0, "log_odds_max", "above 0, up to 10",
                config.log_odds_max);
  rules.require(config.log_odds_hit + config.log_odds_min >= 0.0, "log_odds_hit",
                "no less than -log_odds_min, so that one hit makes a free cell occupied", config.log_odds_hit);
  rules.require(config.forget_s > 0.0, "forget_s", "positive", config.forget_s);
  return rules.broken();
}

OccupancyMap::OccupancyMap(const MapConfig& config, const StereoGeometry& geometry)
    : config_(config),
      geometry_(geometry),
      tree_((throwIfBroken(check(config)), config.resolution_m)),
      orientations_(tree_.getTreeDepth() + 1) {
  tree_.setClampingThresMin(octomap::probability(config.log_odds_min));
  tree_.setClampingThresMax(octomap::probability(config.log_odds_max));
  tree_.setProbHit(octomap::probability(config.log_odds_hit));
  tree_.setProbMiss(octomap::probability(config.log_odds_miss));
  const cv::Size size = geometry_.size();
  const Eigen::Vector3d corners_C[] = {geometry_.point(0, 0, 1), geometry_.point(size.width - 1, 0, 1),
                                       geometry_.point(size.width - 1, size.height - 1, 1),
                                       geometry_.point(0, size.height - 1, 1)};
  double longest_ray = 0.0;
  for (const Eigen::Vector3d& corner_C : corners_C) longest_ray = std::max(longest_ray, corner_C.norm());
  Rules rules("map");
  const double smallest_m = config.max_range_m * longest_ray / (kWindowCells / 2 - 2);
  rules.require(config.resolution_m >= smallest_m, "resolution_m",
                "at least " + std::to_string(smallest_m) + " with this max_range_m and field of view",
                config.resolution_m);
  throwIfBroken(rules.broken());
  for (int side = 0; side < 4; ++side) {
    view_sides_C_[side] = corners_C[(side + 1) % 4].cross(corners_C[side]).cast<float>();
  }
}

void OccupancyMap::insert(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C) {
  const Eigen::Isometry3f T_C_M = T_M_C.inverse().cast<float>();
  orientCubes(T_C_M);
  countPoints(depth_m, T_M_C.cast<float>());
  addHits(T_C_M);
  pyramid_.build(depth_m, geometry_, config_.free_band_px, config_.min_ray_fraction);
  addFree({octomap::OcTreeKey(0, 0, 0), 0, T_C_M.translation(), std::numeric_limits<float>::infinity()});
  tree_.settle();
}

/// Neighbouring pixels mostly fall into one cell: runs of them are counted together.
void OccupancyMap::countPoints(const cv::Mat& depth_m, const Eigen::Isometry3f& T_M_C) {
  points_.clear();
  const Eigen::Array3d camera_key = T_M_C.translation().cast<double>().array() / config_.resolution_m + kKeyOrigin;
  if (!(camera_key >= 0.0).all() || !(camera_key <= kLastKey).all()) return;    // outside what an octree can hold
  window_key_ = (0.5 * camera_key).floor().cast<int>() * 2 - kWindowCells / 2;  // even: where a parent begins
  for (int v = 0; v < depth_m.rows; ++v) {
    findCells(depth_m.ptr<float>(v), v, T_M_C);
    findRuns();
    int begin = 0;
    for (const int end : run_ends_) {
      const std::uint32_t cell = row_cells_[begin];
      if (cell != kNoCell) points_.add(cell & kParent, childOfParent(cell), static_cast<std::uint32_t>(end - begin));
      begin = end;
    }
  }
}

/// Where the cell changes along a row, without a branch that no processor could foretell.
void OccupancyMap::findRuns() {
  const int width = static_cast<int>(row_cells_.size());
  run_ends_.resize(width);
  const std::uint32_t* cells = row_cells_.data();
  int* ends = run_ends_.data();
  for (int u = 1; u < width; ++u) {
    *ends = u;
    ends += cells[u] != cells[u - 1];
  }
  *ends++ = width;
  run_ends_.resize(ends - run_ends_.data());
}

/// Cells of a row's points, in a plain loop over local values that the compiler reckons several at once.
FLIGHT_CORRIDOR_WIDE void OccupancyMap::findCells(const float* depth_m, int v, const Eigen::Isometry3f& T_M_C) {
  const int width = geometry_.size().width;
  row_cells_.resize(width);
  std::uint32_t* cells = row_cells_.data();
  const StereoGeometry geometry = geometry_;
  const double band_px = config_.hit_band_px;
  const auto max_range_m = static_cast<float>(config_.max_range_m);
  const double cells_per_m = 1.0 / config_.resolution_m;
  const Eigen::Vector3d at_first = T_M_C.linear().cast<double>() * geometry_.point(0, v, 1);
  const Eigen::Vector3d at_second = T_M_C.linear().cast<double>() * geometry_.point(1, v, 1);
  const Eigen::Vector3f first = (at_first * cells_per_m).cast<float>();
  const Eigen::Vector3f step = ((at_second - at_first) * cells_per_m).cast<float>();
  const Eigen::Vector3d camera = T_M_C.translation().cast<double>() * cells_per_m;
  const Eigen::Vector3f origin = (camera.array() + kKeyOrigin - window_key_.cast<double>()).cast<float>();
  const float first_x = first[0], first_y = first[1], first_z = first[2];
  const float step_x = step[0], step_y = step[1], step_z = step[2];
  const float origin_x = origin[0], origin_y = origin[1], origin_z = origin[2];
  for (int u = 0; u < width; ++u) {
    const float hit_m = geometry.shiftedDepth(depth_m[u], band_px);
    const float inside_m = std::min(max_range_m, hit_m);  // also of NaN
    const auto column = static_cast<float>(u);
    const auto x = static_cast<int>((first_x + step_x * column) * inside_m + origin_x);
    const auto y = static_cast<int>((first_y + step_y * column) * inside_m + origin_y);
    const auto z = static_cast<int>((first_z + step_z * column) * inside_m + origin_z);
    const auto cell = static_cast<std::uint32_t>(x | y << kWindowBits | z << 2 * kWindowBits);
    cells[u] = cell | -static_cast<std::uint32_t>(!(hit_m <= max_range_m));
  }
}

/// Cells with points enough for their distance are hit: a full face shows f^2 r^2 / Z^2 of them.
void OccupancyMap::addHits(const Eigen::Isometry3f& T_C_M) {
  const StereoCalibration& calibration = geometry_.calibration();
  const double face_px_m2 = calibration.fx_px * calibration.fy_px * config_.resolution_m * config_.resolution_m;
  const auto enough_m2 = static_cast<float>(config_.hit_fraction * face_px_m2);
  const Orientation& parent = orientations_[tree_.getTreeDepth() - 1];
  const auto min_points = static_cast<std::uint32_t>(config_.min_hit_points);
  for (const CellCounts::Cube& cube : points_.cubes()) {
    const Eigen::Array3i key = window_key_ + placeInWindow(cube.key);
    const Eigen::Array3d corner_M = (key.cast<double>() + 1.0 - kKeyOrigin) * config_.resolution_m;
    const float middle_m = (T_C_M * corner_M.matrix().cast<float>()).z();
    unsigned hits = 0;
    for (unsigned i = 0; i < 8; ++i) {
      const float depth_m = middle_m + parent.z_m[i];
      const bool is_hit = cube.counts[i] >= min_points && depth_m > 0.0f &&
                          static_cast<float>(cube.counts[i]) * depth_m * depth_m >= enough_m2;
      hits |= static_cast<unsigned>(is_hit) << i;
    }
    if (hits == 0 || (key < 0).any() || (key > kLastKey).any()) continue;
    const Eigen::Array<octomap::key_type, 3, 1> k = key.cast<octomap::key_type>();
    addToChildren(octomap::OcTreeKey(k[0], k[1], k[2]), tree_.getTreeDepth() - 1, hits, config_.log_odds_hit);
  }
}

void OccupancyMap::orientCubes(const Eigen::Isometry3f& T_C_M) {
  for (unsigned depth = 0; depth < orientations_.size(); ++depth) {
    const Eigen::Matrix3f half_edges = T_C_M.linear() * static_cast<float>(0.5 * tree_.getNodeSize(depth));
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

/// Depth-first over the cubes that may hold free cells: misses for the free ones, at the coarsest level that holds.
void OccupancyMap::addFree(const Cube& cube) {
  const unsigned depth = cube.depth + 1;
  Parts parts;
  project(cube, parts);
  const unsigned seen = bits(parts.is_seen);
  unsigned free = 0;
  for (unsigned i = 0; i < 8; ++i) {
    if (seen >> i & 1u) free |= static_cast<unsigned>(isFree(parts, i, depth)) << i;
  }
  if (free != 0) addToChildren(cube.key, cube.depth, free, config_.log_odds_miss);
  if (depth == tree_.getTreeDepth()) return;
  const unsigned rest = (seen & ~free) | bits(parts.is_near);
  for (unsigned i = 0; i < 8; ++i) {
    if ((rest >> i & 1u) == 0) continue;
    const bool is_near = parts.is_near[i] != 0;
    const float farthest_m = is_near ? cube.farthest_m : pyramid_.farthest(parts.tiles(i));
    if (parts.near_m[i] + cellDepth() > farthest_m || (is_near && isBesideView(parts, i, depth))) continue;
    addFree({tree_.childKey(cube.key, cube.depth, i), depth, {parts.x_m[i], parts.y_m[i], parts.z_m[i]}, farthest_m});
  }
}

/// Whether all the rays that meet a part end beyond it. At leaves a share of them is enough.
bool OccupancyMap::isFree(const Parts& parts, unsigned i, unsigned depth) const {
  const DepthPyramid::Tiles tiles = parts.tiles(i);
  if (parts.is_inside[i] == 0 || parts.far_m[i] > static_cast<float>(config_.max_range_m) ||
      parts.far_m[i] > pyramid_.nearest(tiles))
    return false;
  return pyramid_.usableFraction(tiles) >= (depth == tree_.getTreeDepth() ? config_.min_ray_fraction : 1.0);
}

FLIGHT_CORRIDOR_WIDE void OccupancyMap::project(const Cube& cube, Parts& parts) const {
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
    parts.left[i] = tileAt(left_px, last_u);
    parts.right[i] = tileAt(right_px + 1.0f, last_u);
    parts.top[i] = tileAt(top_px, last_v);
    parts.bottom[i] = tileAt(bottom_px + 1.0f, last_v);
  }
}

/// Whether a part lies outside one of the planes through the image's borders: for those too near to be projected.
bool OccupancyMap::isBesideView(const Parts& parts, unsigned i, unsigned depth) const {
  const Eigen::Vector3f centre_C(parts.x_m[i], parts.y_m[i], parts.z_m[i]);
  return std::any_of(view_sides_C_.begin(), view_sides_C_.end(), [&](const Eigen::Vector3f& normal_C) {
    return normal_C.dot(centre_C) > normal_C.cwiseAbs().dot(orientations_[depth].reach);
  });
}

void OccupancyMap::insertBeam(const Eigen::Vector3d& origin_M, const Eigen::Vector3d& end_M, bool hit) {
  octomap::OcTreeKey end;
  if (!origin_M.allFinite() || !end_M.allFinite() || !tree_.coordToKeyChecked(toOctomap(end_M), end)) return;
  beam_.reset();
  if (!tree_.computeRayKeys(toOctomap(origin_M), toOctomap(end_M), beam_)) return;
  const unsigned parents_depth = tree_.getTreeDepth() - 1;
  const auto add = [&](const octomap::OcTreeKey& cell, double log_odds) {
    addToChildren(cell, parents_depth, 1u << octomap::computeChildIdx(cell, 0), log_odds);
  };
  for (const octomap::OcTreeKey& cell : beam_) add(cell, config_.log_odds_miss);
  if (hit) add(end, config_.log_odds_hit);
  tree_.settle();
}

void OccupancyMap::addToChildren(const octomap::OcTreeKey& key, unsigned depth, unsigned children, double log_odds) {
  tree_.addToChildren(key, depth, children, static_cast<float>(log_odds));
  if (!config_.frame_id.empty()) rememberBlocks(key, depth, children);
}

/// Notes that some children of a cube were seen now. A cube larger than a block holds several.
void OccupancyMap::rememberBlocks(const octomap::OcTreeKey& key, unsigned depth, unsigned children) {
  if (depth < tree_.getTreeDepth() - kBlockLevels) {
    for (unsigned i = 0; i < 8; ++i) {
      if (children >> i & 1u) rememberBlocks(tree_.childKey(key, depth, i), depth + 1, kAllChildren);
    }
    return;
  }
  const std::uint64_t lowest = packed(key) & ~packed(kBlockCells - 1, kBlockCells - 1, kBlockCells - 1);
  if (lowest == last_block_) return;
  last_block_ = lowest;
  seen_s_[lowest] = now_s_;
}

void OccupancyMap::keepAround(const Eigen::Vector3d& centre_M, double stamp_s) {
  now_s_ = stamp_s;
  last_block_ = kNoBlock;
  const Eigen::AlignedBox3d window(centre_M.array() - config_.max_range_m, centre_M.array() + config_.max_range_m);
  for (auto block = seen_s_.begin(); block != seen_s_.end();) {
    const octomap::OcTreeKey low = unpacked(block->first);
    if (std::abs(stamp_s - block->second) <= config_.forget_s && touches(window, low)) {
      ++block;
      continue;
    }
    octomap::OcTreeKey high = low;
    for (unsigned axis = 0; axis < 3; ++axis) high[axis] = static_cast<octomap::key_type>(low[axis] + kBlockCells - 1);
    tree_.forget(low, high);
    block = seen_s_.erase(block);
  }
}

bool OccupancyMap::touches(const Eigen::AlignedBox3d& box_M, const octomap::OcTreeKey& block) const {
  const Eigen::Array3d low_M = (Eigen::Array3d(block[0], block[1], block[2]) - kKeyOrigin) * config_.resolution_m;
  return box_M.intersects(Eigen::AlignedBox3d(low_M, low_M + kBlockCells * config_.resolution_m));
}

void OccupancyMap::clear() {
  tree_.clear();
  seen_s_.clear();
}

void OccupancyMap::clear(const Eigen::AlignedBox3d& box_M) {
  octomap::OcTreeKey low, high;
  const auto key = [&](double coordinate_m) {
    const double cell = std::floor(coordinate_m / config_.resolution_m) + kKeyOrigin;
    return static_cast<octomap::key_type>(std::clamp(cell, 0.0, static_cast<double>(kLastKey)));
  };
  for (unsigned axis = 0; axis < 3; ++axis) {
    low[axis] = key(box_M.min()[axis]);
    high[axis] = key(box_M.max()[axis]);
  }
  tree_.forget(low, high);
}

}  // namespace flight_corridor
