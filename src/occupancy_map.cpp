#include "flight_corridor/occupancy_map.hpp"

#include <algorithm>
#include <cmath>

#include "flight_corridor/types.hpp"

namespace flight_corridor {

namespace {

constexpr int kKeyOrigin = 32768;  // OctoMap's key of the coordinate 0
constexpr int kLastKey = 65535;
constexpr float kSmallestDepth_m = 0.05f;  // cubes nearer than this reach behind the camera's optical centre
constexpr unsigned kWindowBits = 10;       // of a cell's place on one axis of the window around the camera
constexpr int kWindowCells = 1 << kWindowBits;
constexpr std::uint32_t kNoCell = 0x80000000;
constexpr unsigned kBlockLevels = 4;  // blocks of 16 x 16 x 16 cells are forgotten together
constexpr unsigned kBlockCells = 1u << kBlockLevels;
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

}  // namespace

/// A cube of the octree, known to it or not.
struct OccupancyMap::Cube {
  octomap::OcTreeKey key;    // of its lowest corner's cell
  unsigned depth;            // 0 = root
  Eigen::Vector3f centre_C;  // [m]
};

/// The eight parts of a cube, side by side so that the compiler reckons several at once. Each is bounded by a box
/// square to the camera, whose image is bounded by its sides at its nearest or farthest depth.
struct OccupancyMap::Parts {
  float x_m[8], y_m[8], z_m[8];              // centres in C
  float near_m[8], far_m[8];                 // depths of the box
  int left[8], right[8], top[8], bottom[8];  // tiles of its image; senseless for boxes that are too near
  int is_outside[8], is_inside[8];           // the image, wholly
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
      half_edges_C_(tree_.getTreeDepth() + 1),
      cube_reach_C_(tree_.getTreeDepth() + 1) {
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
  const double smallest_m = config.max_range_m * longest_ray / (kWindowCells / 2 - 1);
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
  countPoints(depth_m, T_M_C.cast<float>());
  addHits(T_C_M);
  pyramid_.build(depth_m, geometry_, config_.free_band_px, config_.min_ray_fraction);
  orientCubes(T_C_M);
  addFree({octomap::OcTreeKey(0, 0, 0), 0, T_C_M.translation()});
  tree_.settle();
}

/// Neighbouring pixels mostly fall into one cell: runs of them are counted together.
void OccupancyMap::countPoints(const cv::Mat& depth_m, const Eigen::Isometry3f& T_M_C) {
  points_.clear();
  const Eigen::Array3d camera_key = T_M_C.translation().cast<double>().array() / config_.resolution_m + kKeyOrigin;
  window_key_ = camera_key.max(-kKeyOrigin).min(3 * kKeyOrigin).floor().cast<int>() - kWindowCells / 2;
  for (int v = 0; v < depth_m.rows; ++v) {
    findCells(depth_m.ptr<float>(v), v, T_M_C);
    for (int u = 0, first = 0; u < depth_m.cols; u = first) {
      while (++first < depth_m.cols && row_cells_[first] == row_cells_[u]) {
      }
      if ((row_cells_[u] & kNoCell) == 0) points_.add(row_cells_[u], static_cast<std::uint32_t>(first - u));
    }
  }
}

/// Cells of a row's points, in plain loops over local values that the compiler reckons several at once.
void OccupancyMap::findCells(const float* depth_m, int v, const Eigen::Isometry3f& T_M_C) {
  const int width = geometry_.size().width;
  row_hit_m_.resize(width);
  row_cells_.assign(width, 0);
  float* hit_m = row_hit_m_.data();
  std::uint32_t* cells = row_cells_.data();
  const StereoGeometry geometry = geometry_;
  const double band_px = config_.hit_band_px;
  const auto kNone = static_cast<float>(kNaN);
  const auto max_range_m = static_cast<float>(config_.max_range_m);
  for (int u = 0; u < width; ++u) hit_m[u] = geometry.shiftedDepth(depth_m[u], band_px);
  for (int u = 0; u < width; ++u) hit_m[u] = hit_m[u] <= max_range_m ? hit_m[u] : kNone;

  const Eigen::Vector3f at_first = T_M_C.linear() * geometry_.point(0, v, 1).cast<float>();
  const Eigen::Vector3f step = T_M_C.linear() * (geometry_.point(1, v, 1) - geometry_.point(0, v, 1)).cast<float>();
  const double cells_per_m = 1.0 / config_.resolution_m;
  const auto kLast = static_cast<float>(kWindowCells - 1);
  for (int axis = 0; axis < 3; ++axis) {
    const auto first = static_cast<float>(at_first[axis] * cells_per_m);
    const auto next = static_cast<float>(step[axis] * cells_per_m);
    const auto origin = static_cast<float>(T_M_C.translation()[axis] * cells_per_m + kKeyOrigin - window_key_[axis]);
    const unsigned shift = kWindowBits * axis;
    for (int u = 0; u < width; ++u) {
      const float place = (first + next * static_cast<float>(u)) * hit_m[u] + origin;
      const float inside = std::min(std::max(0.0f, place), kLast);  // 0 for NaN
      const auto cell = static_cast<std::uint32_t>(static_cast<int>(inside)) << shift;
      cells[u] |= inside == place ? cell : kNoCell;
    }
  }
}

/// Cells with points enough for their distance are hit: a full face shows f^2 r^2 / Z^2 of them.
void OccupancyMap::addHits(const Eigen::Isometry3f& T_C_M) {
  const StereoCalibration& calibration = geometry_.calibration();
  const double face_px_m2 = calibration.fx_px * calibration.fy_px * config_.resolution_m * config_.resolution_m;
  const auto min_points = static_cast<std::uint32_t>(config_.min_hit_points);
  points_.forEach([&](const CellCounts::Entry& entry) {
    if (entry.count < min_points) return;
    const Eigen::Array3i key = window_key_ + placeInWindow(entry.cell);
    if ((key < 0).any() || (key > kLastKey).any()) return;  // outside what an octree can hold
    const Eigen::Array3d centre_M = (key.cast<double>() + 0.5 - kKeyOrigin) * config_.resolution_m;
    const double depth_m = (T_C_M * centre_M.matrix().cast<float>()).z();
    if (depth_m > 0.0 && entry.count * depth_m * depth_m >= config_.hit_fraction * face_px_m2) {
      const Eigen::Array<octomap::key_type, 3, 1> k = key.cast<octomap::key_type>();
      add(octomap::OcTreeKey(k[0], k[1], k[2]), tree_.getTreeDepth(), config_.log_odds_hit);
    }
  });
}

void OccupancyMap::orientCubes(const Eigen::Isometry3f& T_C_M) {
  for (unsigned depth = 0; depth < half_edges_C_.size(); ++depth) {
    half_edges_C_[depth] = T_C_M.linear() * static_cast<float>(0.5 * tree_.getNodeSize(depth));
    cube_reach_C_[depth] = half_edges_C_[depth].cwiseAbs().rowwise().sum();
  }
}

/// Depth-first over the cubes that may hold free cells: misses for the free ones, at the coarsest level that holds.
void OccupancyMap::addFree(const Cube& cube) {
  const unsigned depth = cube.depth + 1;
  Parts parts;
  project(cube, parts);
  for (unsigned child = 0; child < 8; ++child) {
    const Sight sight = look(parts, child, depth);
    if (sight == Sight::Nothing || (sight == Sight::Mixed && depth == tree_.getTreeDepth())) continue;
    const octomap::OcTreeKey key = tree_.childKey(cube.key, cube.depth, child);
    if (sight == Sight::Free) {
      add(key, depth, config_.log_odds_miss);
    } else {
      addFree({key, depth, {parts.x_m[child], parts.y_m[child], parts.z_m[child]}});
    }
  }
}

void OccupancyMap::project(const Cube& cube, Parts& parts) const {
  const Eigen::Matrix3f& half_edges_C = half_edges_C_[cube.depth + 1];
  const Eigen::Vector3f& reach_C = cube_reach_C_[cube.depth + 1];
  const StereoCalibration& calibration = geometry_.calibration();
  const float fx = static_cast<float>(calibration.fx_px), fy = static_cast<float>(calibration.fy_px);
  const float cx = static_cast<float>(calibration.cx_px), cy = static_cast<float>(calibration.cy_px);
  const float last_u = static_cast<float>(geometry_.size().width - 1);
  const float last_v = static_cast<float>(geometry_.size().height - 1);
  for (int i = 0; i < 8; ++i) {
    const float a = i & 1 ? 1.0f : -1.0f, b = i & 2 ? 1.0f : -1.0f, c = i & 4 ? 1.0f : -1.0f;
    parts.x_m[i] = cube.centre_C[0] + a * half_edges_C(0, 0) + b * half_edges_C(0, 1) + c * half_edges_C(0, 2);
    parts.y_m[i] = cube.centre_C[1] + a * half_edges_C(1, 0) + b * half_edges_C(1, 1) + c * half_edges_C(1, 2);
    parts.z_m[i] = cube.centre_C[2] + a * half_edges_C(2, 0) + b * half_edges_C(2, 1) + c * half_edges_C(2, 2);
  }
  for (int i = 0; i < 8; ++i) {
    parts.near_m[i] = parts.z_m[i] - reach_C[2];
    parts.far_m[i] = parts.z_m[i] + reach_C[2];
    const float per_near = 1.0f / parts.near_m[i], per_far = 1.0f / parts.far_m[i];
    const float left_m = parts.x_m[i] - reach_C[0], right_m = parts.x_m[i] + reach_C[0];
    const float top_m = parts.y_m[i] - reach_C[1], bottom_m = parts.y_m[i] + reach_C[1];
    const float left_px = left_m * (left_m < 0.0f ? per_near : per_far) * fx + cx;
    const float right_px = right_m * (right_m > 0.0f ? per_near : per_far) * fx + cx;
    const float top_px = top_m * (top_m < 0.0f ? per_near : per_far) * fy + cy;
    const float bottom_px = bottom_m * (bottom_m > 0.0f ? per_near : per_far) * fy + cy;
    parts.is_outside[i] = (right_px < 0.0f) | (left_px > last_u) | (bottom_px < 0.0f) | (top_px > last_v);
    parts.is_inside[i] = (left_px >= 0.0f) & (right_px <= last_u) & (top_px >= 0.0f) & (bottom_px <= last_v);
    parts.left[i] = tileAt(left_px, last_u);
    parts.right[i] = tileAt(right_px + 1.0f, last_u);
    parts.top[i] = tileAt(top_px, last_v);
    parts.bottom[i] = tileAt(bottom_px + 1.0f, last_v);
  }
}

/// What the rays that meet a part say of it. At leaves a share of the rays is enough.
OccupancyMap::Sight OccupancyMap::look(const Parts& parts, unsigned i, unsigned depth) const {
  if (parts.far_m[i] <= 0.0f || parts.near_m[i] > static_cast<float>(config_.max_range_m)) return Sight::Nothing;
  if (parts.near_m[i] < kSmallestDepth_m) return isBesideView(parts, i, depth) ? Sight::Nothing : Sight::Mixed;
  if (parts.is_outside[i]) return Sight::Nothing;

  const DepthPyramid::Tiles tiles{parts.left[i], parts.top[i], parts.right[i], parts.bottom[i]};
  const DepthPyramid::Reach reach = pyramid_.reach(tiles);
  if (parts.near_m[i] + 2.0f * cube_reach_C_.back().z() > reach.farthest_m) return Sight::Nothing;
  if (!parts.is_inside[i] || parts.far_m[i] > reach.nearest_m ||
      parts.far_m[i] > static_cast<float>(config_.max_range_m))
    return Sight::Mixed;
  const double enough = depth == tree_.getTreeDepth() ? config_.min_ray_fraction : 1.0;
  return pyramid_.usableFraction(tiles) >= enough ? Sight::Free : Sight::Mixed;
}

/// Whether a part lies outside one of the planes through the image's borders: for those too near to be projected.
bool OccupancyMap::isBesideView(const Parts& parts, unsigned i, unsigned depth) const {
  const Eigen::Vector3f centre_C(parts.x_m[i], parts.y_m[i], parts.z_m[i]);
  return std::any_of(view_sides_C_.begin(), view_sides_C_.end(), [&](const Eigen::Vector3f& normal_C) {
    return normal_C.dot(centre_C) > normal_C.cwiseAbs().dot(cube_reach_C_[depth]);
  });
}

void OccupancyMap::insertBeam(const Eigen::Vector3d& origin_M, const Eigen::Vector3d& end_M, bool hit) {
  octomap::OcTreeKey end;
  if (!origin_M.allFinite() || !end_M.allFinite() || !tree_.coordToKeyChecked(toOctomap(end_M), end)) return;
  beam_.reset();
  if (!tree_.computeRayKeys(toOctomap(origin_M), toOctomap(end_M), beam_)) return;
  for (const octomap::OcTreeKey& key : beam_) add(key, tree_.getTreeDepth(), config_.log_odds_miss);
  if (hit) add(end, tree_.getTreeDepth(), config_.log_odds_hit);
  tree_.settle();
}

void OccupancyMap::add(const octomap::OcTreeKey& key, unsigned depth, double log_odds) {
  tree_.add(key, depth, static_cast<float>(log_odds));
  if (!config_.frame_id.empty()) rememberBlocks(key, depth);
}

/// Notes that a cube was seen now. A cube larger than a block holds several.
void OccupancyMap::rememberBlocks(const octomap::OcTreeKey& key, unsigned depth) {
  const unsigned block_depth = tree_.getTreeDepth() - kBlockLevels;
  if (depth < block_depth) {
    for (unsigned child = 0; child < 8; ++child) rememberBlocks(tree_.childKey(key, depth, child), depth + 1);
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
