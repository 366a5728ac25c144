#include "flight_corridor/map/obstacle_memory.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

ObstacleMemory::ObstacleMemory(const MapConfig& config) : config_(config), tree_(config) {}

void ObstacleMemory::add(const std::vector<Eigen::Vector3d>& points_M, double stamp_s) {
  for (const Eigen::Vector3d& p_M : points_M) {
    octomap::OcTreeKey cell;
    if (!tree_.coordToKeyChecked(p_M.x(), p_M.y(), p_M.z(), cell)) continue;
    const auto [known, is_new] = seen_s_.try_emplace(cell, stamp_s);
    if (!is_new && known->second == stamp_s) continue;  // once a pair
    known->second = stamp_s;
    tree_.updateNode(cell, true);
  }
}

void ObstacleMemory::update(double stamp_s, const Look& look) {
  for (const auto& [cell, seen_s] : seen_s_) {
    const octomap::point3d centre = tree_.keyToCoord(cell);
    if (look({centre.x(), centre.y(), centre.z()}) == Sight::Clear) tree_.updateNode(cell, false);
  }
  for (auto cell = seen_s_.begin(); cell != seen_s_.end();) {
    const octomap::OcTreeNode* node = tree_.search(cell->first);
    const bool is_old = !(stamp_s - cell->second <= config_.forget_s);
    if (node && tree_.isNodeOccupied(node) && !is_old) {
      ++cell;
      continue;
    }
    forget(cell->first);
    cell = seen_s_.erase(cell);
  }
}

double ObstacleMemory::seen(const Eigen::Vector3d& p_M) const {
  octomap::OcTreeKey cell;
  const bool has_key = tree_.coordToKeyChecked(p_M.x(), p_M.y(), p_M.z(), cell);
  const auto known = has_key ? seen_s_.find(cell) : seen_s_.end();
  return known == seen_s_.end() ? -kInfinity : known->second;
}

void ObstacleMemory::clear(const Eigen::AlignedBox3d& box_M) {
  const double half_m = 0.5 * config_.resolution_m;
  for (auto cell = seen_s_.begin(); cell != seen_s_.end();) {
    const octomap::point3d centre = tree_.keyToCoord(cell->first);
    const Eigen::Vector3d centre_M(centre.x(), centre.y(), centre.z());
    const Eigen::AlignedBox3d cube_M(centre_M.array() - half_m, centre_M.array() + half_m);
    if (box_M.intersects(cube_M)) {
      forget(cell->first);
      cell = seen_s_.erase(cell);
    } else {
      ++cell;
    }
  }
}

void ObstacleMemory::clear() {
  tree_.clear();
  seen_s_.clear();
}

}  // namespace flight_corridor
