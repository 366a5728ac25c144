#include "flight_corridor/map/box_cells.hpp"

#include <algorithm>
#include <cmath>

#include "flight_corridor/map/evidence_tree.hpp"

namespace flight_corridor {

namespace {

/// The cubes of a tree that may hold cells centred in a box, or that meet it: coarse to fine.
class BoxSearch {
 public:
  BoxSearch(const octomap::OcTree& tree, const Box& box, double beside_m)
      : tree_(tree), T_F_M_(box.T_M_F.inverse()), half_m_(0.5 * box.size_m), beside_m_(beside_m) {
    const Eigen::Vector3d reach_M = centre(box).cwiseAbs() + box.T_M_F.linear().cwiseAbs() * half_m_;
    is_within_ = (reach_M.array() < 0.5 * tree.getNodeSize(0)).all();
  }

  /// @param enters(node, centre_M, edge): whether the cells of a cube, so many along its edge, are asked for.
  /// @param visit(centre_M) of each of those cells.
  template <typename Enters, typename Visit>
  void run(const Enters& enters, const Visit& visit) const {
    if (is_within_ && tree_.getRoot()) descend(tree_.getRoot(), octomap::OcTreeKey(0, 0, 0), 0, enters, visit);
  }

  /// Whether all cells of a cube, so many along its edge, are centred in the box, and not at its border.
  bool holds(const Eigen::Vector3d& centre_M, double edge) const {
    return isIn(half_m_.array() - ball((edge - 1.0) * tree_.getResolution()) - kTouch_m, centre_M);
  }

 private:
  static double ball(double between_centres_m) { return 0.5 * std::sqrt(3.0) * between_centres_m; }

  /// A pruned leaf stands for all that is below it.
  template <typename Enters, typename Visit>
  void descend(const octomap::OcTreeNode* node, const octomap::OcTreeKey& key, unsigned depth, const Enters& enters,
               const Visit& visit) const {
    const double edge = 1u << (EvidenceTree::kDepth - depth);  // in cells
    const Eigen::Vector3d centre_M =
        (Eigen::Array3d(key[0], key[1], key[2]) + 0.5 * edge - EvidenceTree::kKeyOrigin) * tree_.getResolution();
    if (!mayMeet(centre_M, (edge - 1.0) * tree_.getResolution()) || !enters(*node, centre_M, edge)) return;
    if (depth == EvidenceTree::kDepth) return visit(centre_M);
    const bool is_leaf = !tree_.nodeHasChildren(node);
    for (unsigned i = 0; i < 8; ++i) {
      if (!is_leaf && !tree_.nodeChildExists(node, i)) continue;
      descend(is_leaf ? node : tree_.getNodeChild(node, i), EvidenceTree::childKey(key, depth, i), depth + 1, enters,
              visit);
    }
  }

  /// The ball about the centres of a cube's cells, and the box.
  bool mayMeet(const Eigen::Vector3d& centre_M, double between_centres_m) const {
    return isIn(half_m_.array() + ball(between_centres_m) + beside_m_, centre_M);
  }

  bool isIn(const Eigen::Array3d& half_m, const Eigen::Vector3d& p_M) const {
    const Eigen::Vector3d away_F = T_F_M_ * p_M - Eigen::Vector3d(half_m_.x(), 0.0, 0.0);
    return (away_F.array().abs() <= half_m).all();
  }

  const octomap::OcTree& tree_;
  Eigen::Isometry3d T_F_M_;
  Eigen::Vector3d half_m_;
  double beside_m_;  // how far beside the box the centres of cells are asked for
  bool is_within_;
};

}  // namespace

OccupiedCell nearestOccupied(const octomap::OcTree& tree, const Box& box,
                             const std::function<bool(const Eigen::Vector3d& centre_M)>& counts) {
  const double cell_m = tree.getResolution();
  const bool is_thin = box.size_m.minCoeff() < cell_m;  // it may hold no cell's centre
  const Eigen::Vector3d forward_M = box.T_M_F.linear().col(0);
  const double half_cell_m = 0.5 * cell_m * forward_M.lpNorm<1>();
  const auto is_occupied = [&](const auto& node, const auto&, double) { return tree.isNodeOccupied(node); };
  OccupiedCell nearest;
  BoxSearch(tree, box, is_thin ? cell_m : kTouch_m).run(is_occupied, [&](const Eigen::Vector3d& cell_M) {
    const double begin_m = std::max(0.0, forward_M.dot(cell_M - box.T_M_F.translation()) - half_cell_m);
    if (begin_m >= nearest.clear_distance_m) return;
    if (!contains(box, cell_M) && !(is_thin && intersects(box, cell_M, cell_m))) return;
    if (counts(cell_M)) nearest = {begin_m, cell_M};
  });
  return nearest;
}

double unknownFraction(const octomap::OcTree& tree, const Box& box) {
  const BoxSearch search(tree, box, kTouch_m);
  double known = 0.0;
  const auto enters = [&](const octomap::OcTreeNode& node, const Eigen::Vector3d& centre_M, double edge) {
    const bool is_counted = !tree.nodeHasChildren(&node) && search.holds(centre_M, edge);
    if (is_counted) known += edge * edge * edge;
    return !is_counted;
  };
  search.run(enters, [&](const Eigen::Vector3d& cell_M) { known += contains(box, cell_M); });
  return std::clamp(1.0 - known * std::pow(tree.getResolution(), 3) / box.size_m.prod(), 0.0, 1.0);
}

}  // namespace flight_corridor
