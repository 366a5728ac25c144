#include "flight_corridor/map/occupancy_map.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace flight_corridor {

namespace {

constexpr double kMostCellsAlongARay = 320.0;  // from the camera to the corner of the view

octomap::point3d toOctomap(const Eigen::Vector3d& p) {
  return octomap::point3d(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
}

}  // namespace

OccupancyMap::OccupancyMap(const MapConfig& config, const StereoGeometry& geometry, double nearest_m)
    : config_((throwIfBroken(check(config)), config)),
      geometry_(geometry),
      tree_(config.resolution_m),
      hit_rule_(config, geometry.calibration()),
      free_space_(config, geometry, nearest_m) {
  double longest_ray = 0.0;
  for (const int u : {0, geometry.size().width - 1}) {
    for (const int v : {0, geometry.size().height - 1})
      longest_ray = std::max(longest_ray, geometry.point(u, v, 1.0).norm());
  }
  Rules rules("map");
  const double smallest_m = config.max_range_m * longest_ray / kMostCellsAlongARay;
  rules.require(config.resolution_m >= smallest_m, "resolution_m",
                "at least " + std::to_string(smallest_m) + " with this max_range_m and field of view",
                config.resolution_m);
  throwIfBroken(rules.broken());
  tree_.setClampingThresMin(octomap::probability(config.log_odds_min));
  tree_.setClampingThresMax(octomap::probability(config.log_odds_max));
  tree_.setProbHit(octomap::probability(config.log_odds_hit));
  tree_.setProbMiss(octomap::probability(config.log_odds_miss));
}

void OccupancyMap::insert(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C, bool clears) {
  addHits(countPoints(depth_m, T_M_C, geometry_, config_), T_M_C.inverse());
  if (clears) {
    for (const FreeSpace::Cube& cube : free_space_.find(depth_m, T_M_C)) {
      tree_.add(cube.key, cube.depth, config_.log_odds_miss);
    }
  }
  settle();
}

void OccupancyMap::addHits(const PointCounts& counts, const Eigen::Isometry3d& T_C_M) {
  for (const auto& [key, points] : counts) {
    const Eigen::Array3d corner(key[0], key[1], key[2]);
    const Eigen::Vector3d centre_M = (corner + 0.5 - EvidenceTree::kKeyOrigin) * config_.resolution_m;
    const auto depth_m = static_cast<float>((T_C_M * centre_M).z());
    if (hit_rule_.isHit(points, depth_m)) tree_.add(key, EvidenceTree::kDepth, config_.log_odds_hit);
  }
}

void OccupancyMap::insertBeam(const Eigen::Vector3d& origin_M, const Eigen::Vector3d& end_M) {
  const double reach_m = mapReach(config_);
  const auto has_key = [&](const Eigen::Vector3d& p_M) { return (p_M.array().abs() < reach_m).all(); };
  octomap::OcTreeKey end;
  if (!has_key(origin_M) || !has_key(end_M) || !tree_.coordToKeyChecked(toOctomap(end_M), end)) return;
  beam_.reset();
  if (!tree_.computeRayKeys(toOctomap(origin_M), toOctomap(end_M), beam_)) return;
  for (const octomap::OcTreeKey& cell : beam_) tree_.add(cell, EvidenceTree::kDepth, config_.log_odds_miss);
  tree_.add(end, EvidenceTree::kDepth, config_.log_odds_hit);
  settle();
}

void OccupancyMap::settle() {
  for (const octomap::OcTreeKey& block : tree_.changed()) seen_s_[block] = now_s_;
  tree_.settle();
}

void OccupancyMap::keepAround(const Eigen::Vector3d& centre_M, double stamp_s) {
  now_s_ = stamp_s;
  const Eigen::AlignedBox3d window(centre_M.array() - config_.max_range_m, centre_M.array() + config_.max_range_m);
  for (auto block = seen_s_.begin(); block != seen_s_.end();) {
    const octomap::OcTreeKey& low = block->first;
    if (std::abs(stamp_s - block->second) <= config_.forget_s && touches(window, low)) {
      ++block;
      continue;
    }
    octomap::OcTreeKey high = low;
    for (unsigned axis = 0; axis < 3; ++axis) {
      high[axis] = static_cast<octomap::key_type>(low[axis] + EvidenceTree::kBlockCells - 1);
    }
    tree_.forget(low, high);
    block = seen_s_.erase(block);
  }
}

bool OccupancyMap::touches(const Eigen::AlignedBox3d& box_M, const octomap::OcTreeKey& block) const {
  const Eigen::Array3d low_M =
      (Eigen::Array3d(block[0], block[1], block[2]) - EvidenceTree::kKeyOrigin) * config_.resolution_m;
  return box_M.intersects(Eigen::AlignedBox3d(low_M, low_M + EvidenceTree::kBlockCells * config_.resolution_m));
}

void OccupancyMap::clear() {
  tree_.clear();
  seen_s_.clear();
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
