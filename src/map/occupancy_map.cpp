#include "flight_corridor/map/occupancy_map.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "flight_corridor/parameter.hpp"

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
      tree_(config),
      evidence_(config, geometry, nearest_m) {
  double longest_ray = 0.0;
  for (const int u : {0, geometry.size().width - 1}) {
    for (const int v : {0, geometry.size().height - 1})
      longest_ray = std::max(longest_ray, geometry.point(u, v, 1.0).norm());
  }
  const double smallest_m = config.max_range_m * longest_ray / kMostCellsAlongARay;
  const std::string rule = "at least " + std::to_string(smallest_m) + " with this max_range_m and field of view";
  throwIfBroken(brokenRules(
      {{"map/resolution_m", &config_.resolution_m, Rule().where(config_.resolution_m >= smallest_m, rule)}}));
}

/// Block by block, of those that may be in view.
void OccupancyMap::insert(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C, bool clears) {
  evidence_.look(depth_m, T_M_C, clears);
  Eigen::AlignedBox3d view_M(T_M_C.translation());
  for (const int u : {-1, geometry_.size().width}) {
    for (const int v : {-1, geometry_.size().height}) view_M.extend(T_M_C * geometry_.point(u, v, config_.max_range_m));
  }
  const octomap::OcTreeKey first = EvidenceTree::blockOf(cellOf(view_M.min())), last = cellOf(view_M.max());
  EvidenceTree::Block<float> log_odds;
  for (unsigned x = first[0]; x <= last[0]; x += EvidenceTree::kBlockCells) {
    for (unsigned y = first[1]; y <= last[1]; y += EvidenceTree::kBlockCells) {
      for (unsigned z = first[2]; z <= last[2]; z += EvidenceTree::kBlockCells) {
        const auto key = [](unsigned k) { return static_cast<octomap::key_type>(k); };
        const octomap::OcTreeKey block(key(x), key(y), key(z));
        if (!evidence_.find(block, log_odds)) continue;
        tree_.add(block, log_odds);
        seen_s_[block] = now_s_;
      }
    }
  }
}

/// Of the tree's cells the nearest to a place.
octomap::OcTreeKey OccupancyMap::cellOf(const Eigen::Vector3d& p_M) const {
  const Eigen::Array3d cell = (p_M.array() / config_.resolution_m).floor() + EvidenceTree::kKeyOrigin;
  const auto key = [&](double k) {
    return static_cast<octomap::key_type>(std::clamp(k, 0.0, static_cast<double>(EvidenceTree::kLastKey)));
  };
  return {key(cell.x()), key(cell.y()), key(cell.z())};
}

void OccupancyMap::insertBeam(const Eigen::Vector3d& origin_M, const Eigen::Vector3d& end_M) {
  const double reach_m = mapReach(config_);
  const auto has_key = [&](const Eigen::Vector3d& p_M) { return (p_M.array().abs() < reach_m).all(); };
  octomap::OcTreeKey end;
  if (!has_key(origin_M) || !has_key(end_M) || !tree_.coordToKeyChecked(toOctomap(end_M), end)) return;
  beam_.reset();
  if (!tree_.computeRayKeys(toOctomap(origin_M), toOctomap(end_M), beam_)) return;
  for (const octomap::OcTreeKey& cell : beam_) add(cell, false);
  add(end, true);
}

void OccupancyMap::add(const octomap::OcTreeKey& cell, bool is_hit) {
  tree_.updateNode(cell, is_hit);
  seen_s_[EvidenceTree::blockOf(cell)] = now_s_;
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
  tree_.forget(cellOf(box_M.min()), cellOf(box_M.max()));
}

}  // namespace flight_corridor
