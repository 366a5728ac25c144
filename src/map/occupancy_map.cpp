#include "flight_corridor/map/occupancy_map.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr unsigned kBlockLevels = 4;  // blocks of 16 x 16 x 16 cells are forgotten together
constexpr unsigned kBlockCells = 1u << kBlockLevels;
constexpr unsigned kEveryChild = 0xFF;

std::uint64_t packed(std::uint64_t x, std::uint64_t y, std::uint64_t z) { return x | y << 16 | z << 32; }
std::uint64_t packed(const octomap::OcTreeKey& key) { return packed(key[0], key[1], key[2]); }

octomap::OcTreeKey unpacked(std::uint64_t cell) {
  return octomap::OcTreeKey(static_cast<octomap::key_type>(cell), static_cast<octomap::key_type>(cell >> 16),
                            static_cast<octomap::key_type>(cell >> 32));
}

octomap::point3d toOctomap(const Eigen::Vector3d& p) {
  return octomap::point3d(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
}

}  // namespace

OccupancyMap::OccupancyMap(const MapConfig& config, const StereoGeometry& geometry, double nearest_m)
    : config_((throwIfBroken(check(config)), config)),
      tree_(config.resolution_m),
      hit_rule_(config, geometry.calibration()),
      points_(config, geometry),
      free_space_(config, geometry, nearest_m) {
  tree_.setClampingThresMin(octomap::probability(config.log_odds_min));
  tree_.setClampingThresMax(octomap::probability(config.log_odds_max));
  tree_.setProbHit(octomap::probability(config.log_odds_hit));
  tree_.setProbMiss(octomap::probability(config.log_odds_miss));
}

/// Points are counted while free space is found, after it where there is no thread to be had; what the tree is given
/// does not depend on which ends first.
void OccupancyMap::insert(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C, bool clears) {
  static const std::vector<FreeSpace::FreeCubes> kNone;
  const std::vector<FreeSpace::FreeCubes>* free = &kNone;
  workers_.run(2, [&](int part, int) {
    if (part == 1) {
      points_.count(depth_m, T_M_C);
    } else if (clears) {
      free = &free_space_.find(depth_m, T_M_C);
    }
  });
  addHits(T_M_C.inverse().cast<float>());
  for (const FreeSpace::FreeCubes& cubes : *free) {
    for (const FreeSpace::FreeChildren& cube : cubes) {
      addToChildren(cube.key, cube.depth, cube.children, config_.log_odds_miss);
    }
  }
  tree_.settle();
}

void OccupancyMap::addHits(const Eigen::Isometry3f& T_C_M) {
  const Eigen::RowVector3f deeper = T_C_M.linear().row(2) * static_cast<float>(0.5 * config_.resolution_m);
  seen_.clear();
  for (const CellCounts::Cube& cube : points_.cubes()) {
    const Eigen::Array3i key = points_.lowestCell(cube);
    const Eigen::Array3d middle_M = (key.cast<double>() + 1.0 - EvidenceTree::kKeyOrigin) * config_.resolution_m;
    const float middle_m = (T_C_M * middle_M.matrix().cast<float>()).z();
    unsigned hits = 0;
    for (unsigned i = 0; i < 8; ++i) {
      const Eigen::Vector3f side(i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f);
      const float depth_m = middle_m + deeper.dot(side);
      const bool is_hit = hit_rule_.isHit(cube.counts[i], depth_m);
      hits |= static_cast<unsigned>(is_hit) << i;
      if (cube.counts[i] == 0) continue;
      const Eigen::Vector3d centre_M = middle_M.matrix() + 0.5 * config_.resolution_m * side.cast<double>();
      const std::uint32_t points = cube.counts[i];
      seen_.push_back({centre_M, depth_m, points, hit_rule_.face(points, depth_m), is_hit});
    }
    if (hits == 0 || (key < 0).any() || (key > EvidenceTree::kLastKey).any()) continue;
    const Eigen::Array<octomap::key_type, 3, 1> k = key.cast<octomap::key_type>();
    addToChildren(octomap::OcTreeKey(k[0], k[1], k[2]), EvidenceTree::kDepth - 1, hits, config_.log_odds_hit);
  }
}

bool OccupancyMap::showsOutline(const Box& box_M) const {
  return std::any_of(seen_.begin(), seen_.end(), [&](const Seen& cell) {
    return !cell.is_hit && hit_rule_.isUncertain(cell.points, cell.depth_m) && contains(box_M, cell.centre_M);
  });
}

void OccupancyMap::insertBeam(const Eigen::Vector3d& origin_M, const Eigen::Vector3d& end_M) {
  octomap::OcTreeKey end;
  if (!origin_M.allFinite() || !end_M.allFinite() || !tree_.coordToKeyChecked(toOctomap(end_M), end)) return;
  beam_.reset();
  if (!tree_.computeRayKeys(toOctomap(origin_M), toOctomap(end_M), beam_)) return;
  const unsigned parents_depth = EvidenceTree::kDepth - 1;
  const auto add = [&](const octomap::OcTreeKey& cell, double log_odds) {
    addToChildren(cell, parents_depth, 1u << octomap::computeChildIdx(cell, 0), log_odds);
  };
  for (const octomap::OcTreeKey& cell : beam_) add(cell, config_.log_odds_miss);
  add(end, config_.log_odds_hit);
  tree_.settle();
}

void OccupancyMap::addToChildren(const octomap::OcTreeKey& key, unsigned depth, unsigned children, double log_odds) {
  tree_.addToChildren(key, depth, children, static_cast<float>(log_odds));
  if (!config_.frame_id.empty()) rememberBlocks(key, depth, children);
}

/// Notes that some children of a cube were seen now. A cube larger than a block holds several.
void OccupancyMap::rememberBlocks(const octomap::OcTreeKey& key, unsigned depth, unsigned children) {
  if (depth < EvidenceTree::kDepth - kBlockLevels) {
    for (unsigned i = 0; i < 8; ++i) {
      if (children >> i & 1u) rememberBlocks(EvidenceTree::childKey(key, depth, i), depth + 1, kEveryChild);
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
  const Eigen::Array3d low_M =
      (Eigen::Array3d(block[0], block[1], block[2]) - EvidenceTree::kKeyOrigin) * config_.resolution_m;
  return box_M.intersects(Eigen::AlignedBox3d(low_M, low_M + kBlockCells * config_.resolution_m));
}

void OccupancyMap::clear() {
  tree_.clear();
  seen_.clear();
  seen_s_.clear();
  last_block_ = kNoBlock;
}

void OccupancyMap::clear(const Eigen::AlignedBox3d& box_M) {
  if (!(box_M.min().array() <= box_M.max().array()).all()) return;
  octomap::OcTreeKey low, high;
  const auto key = [&](double coordinate_m) {
    const double cell = std::floor(coordinate_m / config_.resolution_m) + EvidenceTree::kKeyOrigin;
    return static_cast<octomap::key_type>(std::clamp(cell, 0.0, static_cast<double>(EvidenceTree::kLastKey)));
  };
  for (unsigned axis = 0; axis < 3; ++axis) {
    low[axis] = key(box_M.min()[axis]);
    high[axis] = key(box_M.max()[axis]);
  }
  tree_.forget(low, high);
}

}  // namespace flight_corridor
