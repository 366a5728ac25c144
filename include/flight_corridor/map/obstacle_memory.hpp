#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <unordered_map>
#include <vector>

#include "flight_corridor/map/evidence_tree.hpp"
#include "flight_corridor/map/map_config.hpp"

namespace flight_corridor {

/// What the newest pair shows at a place.
enum class Sight : std::uint8_t { Nothing, Clear, Unclear };

/// Obstacles that stood in the corridor: an OctoMap of every cell that their patches touched, in a frame M that stands
/// still. A cell stays occupied until later pairs see through it, or for map/forget_s; where the newest pair looks,
/// that pair judges. It holds obstacles that came too near to be matched, or left the view.
class ObstacleMemory {
 public:
  /// What the newest pair shows in a cell, by its centre.
  using Look = std::function<Sight(const Eigen::Vector3d& centre_M)>;

  explicit ObstacleMemory(const MapConfig& config);

  /// Every cell that a point touches becomes occupied.
  void add(const std::vector<Eigen::Vector3d>& points_M, double stamp_s);

  /// Cells that the newest pair sees through become less likely, old ones are forgotten.
  void update(double stamp_s, const Look& look);

  /// When a patch touched the cell of a place last; -inf: none did.
  double seen(const Eigen::Vector3d& p_M) const;

  /// Makes the cells that meet a box unknown.
  void clear(const Eigen::AlignedBox3d& box_M);
  void clear();

  const octomap::OcTree& tree() const { return tree_; }
  octomap::OcTree& tree() { return tree_; }

 private:
  void forget(const octomap::OcTreeKey& cell) { tree_.forget(cell, cell); }

  MapConfig config_;
  EvidenceTree tree_;
  std::unordered_map<octomap::OcTreeKey, double, octomap::OcTreeKey::KeyHash> seen_s_;  // when a patch touched a cell
};

}  // namespace flight_corridor
