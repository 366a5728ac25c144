#include "flight_corridor/corridor/corridor.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr double kSmallest_m = 0.03;  // edge: chance matches form smaller patches anywhere

}  // namespace

Violations check(const CorridorConfig& config) {
  Rules rules("corridor");
  rules.require(0.0 < config.width_m && config.width_m <= 20.0, "width_m", "above 0, up to 20", config.width_m);
  rules.require(0.0 < config.height_m && config.height_m <= 20.0, "height_m", "above 0, up to 20", config.height_m);
  rules.require(0.0 < config.length_m && config.length_m <= 100.0, "length_m", "above 0, up to 100", config.length_m);
  for (int axis = 0; axis < 3; ++axis) {
    rules.require(std::abs(config.offset_m[axis]) <= 10.0, "offset_m", "within 10", config.offset_m[axis]);
  }
  rules.require(0.0 <= config.margin_m && config.margin_m <= 5.0, "margin_m", "0 to 5", config.margin_m);
  rules.require(0.0 <= config.blind_m && config.blind_m < config.length_m, "blind_m", "0 to below length_m",
                config.blind_m);
  rules.require(0.0 <= config.max_unknown_fraction && config.max_unknown_fraction <= 1.0, "max_unknown_fraction",
                "0 to 1", config.max_unknown_fraction);
  rules.require(0.0 <= config.smallest_obstacle_m && config.smallest_obstacle_m <= 1.0, "smallest_obstacle_m", "0 to 1",
                config.smallest_obstacle_m);
  rules.require(0.0 <= config.hold_s && config.hold_s <= 10.0, "hold_s", "0 to 10", config.hold_s);
  rules.require(0.0 <= config.memory_s && config.memory_s <= 10.0, "memory_s", "0 to 10", config.memory_s);
  rules.require(config.max_age_s > 0.0, "max_age_s", "positive", config.max_age_s);
  return rules.broken();
}

double smallestInspected(const CorridorConfig& config) { return std::max(config.smallest_obstacle_m, kSmallest_m); }

/// Leaves that meet the box, and of a pruned one its cells.
BoxCells cellsIn(const octomap::OcTree& tree, const Box& box,
                 const std::function<bool(const Eigen::Vector3d& centre_M)>& counts) {
  const double cell_m = tree.getResolution();
  const Eigen::Vector3d reach_M = 0.5 * (box.T_M_F.linear().cwiseAbs() * box.size_m);
  const auto corner = [&](double side) {
    const Eigen::Vector3f at = (centre(box) + side * reach_M).cast<float>();
    return octomap::point3d(at.x(), at.y(), at.z());
  };
  const Eigen::Vector3d forward_M = box.T_M_F.linear().col(0);
  const double half_cell_m = 0.5 * cell_m * forward_M.lpNorm<1>();
  BoxCells cells;
  const double tree_reach_m = 0.5 * tree.getNodeSize(0);
  if (!((centre(box).cwiseAbs() + reach_M).array() < tree_reach_m).all()) return cells;
  const Eigen::Isometry3d T_F_M = box.T_M_F.inverse();
  const bool is_thin = box.size_m.minCoeff() < cell_m;  // it may hold no cell's centre
  double known = 0.0;
  for (auto leaf = tree.begin_leafs_bbx(corner(-1.0), corner(1.0)); leaf != tree.end_leafs_bbx(); ++leaf) {
    const Eigen::Vector3d middle_M(leaf.getX(), leaf.getY(), leaf.getZ());
    const Eigen::Vector3d half_M = Eigen::Vector3d::Constant(0.5 * (leaf.getSize() - cell_m));
    const Eigen::Array3d low_M = (centre(box) - reach_M - middle_M + half_M).array() / cell_m;
    const Eigen::Array3d high_M = (centre(box) + reach_M - middle_M + half_M).array() / cell_m;
    const double last = std::round(2.0 * half_M.x() / cell_m);
    const Eigen::Array3i first = low_M.floor().max(0.0).min(last).cast<int>();
    const Eigen::Array3i end = high_M.ceil().max(0.0).min(last).cast<int>();
    const bool is_occupied = tree.isNodeOccupied(*leaf);
    for (int x = first.x(); x <= end.x(); ++x) {
      for (int y = first.y(); y <= end.y(); ++y) {
        for (int z = first.z(); z <= end.z(); ++z) {
          const Eigen::Vector3d cell_M = middle_M - half_M + cell_m * Eigen::Vector3d(x, y, z);
          const bool is_in = contains(box.size_m, T_F_M * cell_M);
          known += is_in;
          if (!is_occupied || !(is_in || (is_thin && intersects(box, cell_M, cell_m)))) continue;
          if (!counts(cell_M)) continue;
          const double begin_m = std::max(0.0, forward_M.dot(cell_M - box.T_M_F.translation()) - half_cell_m);
          if (begin_m >= cells.clear_distance_m) continue;
          cells.clear_distance_m = begin_m;
          cells.nearest = cell_M;
        }
      }
    }
  }
  cells.unknown_fraction = std::clamp(1.0 - known * std::pow(cell_m, 3) / box.size_m.prod(), 0.0, 1.0);
  return cells;
}

Box corridorBox(const CorridorConfig& config, const Eigen::Isometry3d& T_M_F) {
  Box box;
  box.T_M_F = T_M_F * Eigen::Translation3d(config.offset_m);
  const double margin = config.margin_m;
  box.size_m = {config.length_m + margin, config.width_m + 2.0 * margin, config.height_m + 2.0 * margin};
  return box;
}

}  // namespace flight_corridor
