#include "flight_corridor/corridor.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr double kTouch_m = 1e-6;       // cells that rounding parts from the box still touch it
constexpr double kKeyOrigin = 32768.0;  // OctoMap's key of the coordinate 0

/// Depth-first over the cubes that meet the box, known to the octree or not, down to its cells.
class Inspection {
 public:
  using Observable = std::function<bool(const Eigen::Vector3d&)>;

  Inspection(const octomap::OcTree& tree, const Box& box, double blind_m, const Observable& observable)
      : tree_(tree), box_(box), blind_m_(blind_m), observable_(observable), T_F_M_(box.T_M_F.inverse()) {}

  CorridorOccupancy run() {
    visit(tree_.getRoot(), octomap::OcTreeKey(0, 0, 0), 0);
    CorridorOccupancy result;
    result.clear_distance_m = clear_distance_m_;
    result.unknown_fraction = observable_cells_ > 0 ? unknown_cells_ / static_cast<double>(observable_cells_) : 1.0;
    return result;
  }

 private:
  /// @param node what the tree knows of the cube: its own node, that of a pruned cube around it, or null.
  void visit(const octomap::OcTreeNode* node, const octomap::OcTreeKey& key, unsigned depth) {
    const double edge_m = tree_.getNodeSize(static_cast<int>(depth));
    const double half_cells = 0.5 * (1u << (tree_.getTreeDepth() - depth));
    Eigen::Vector3d centre_M;
    for (unsigned axis = 0; axis < 3; ++axis)
      centre_M[axis] = (key[axis] + half_cells - kKeyOrigin) * tree_.getResolution();
    if (!intersects(box_, centre_M, edge_m)) return;
    if (depth == tree_.getTreeDepth()) return judge(node, centre_M);

    const bool inner = node && tree_.nodeHasChildren(node);
    for (unsigned child = 0; child < 8; ++child) {
      octomap::OcTreeKey part = key;
      for (unsigned axis = 0; axis < 3; ++axis) {
        if (child >> axis & 1u)
          part[axis] = static_cast<octomap::key_type>(part[axis] + static_cast<unsigned>(half_cells));
      }
      const octomap::OcTreeNode* known = node;
      if (inner) known = tree_.nodeChildExists(node, child) ? tree_.getNodeChild(node, child) : nullptr;
      visit(known, part, depth + 1);
    }
  }

  void judge(const octomap::OcTreeNode* node, const Eigen::Vector3d& centre_M) {
    const Eigen::Vector3d centre_F = T_F_M_ * centre_M;
    if (node && tree_.isNodeOccupied(node)) {
      const double near_face_m = centre_F.x() - 0.5 * tree_.getResolution() * T_F_M_.linear().row(0).lpNorm<1>();
      // A cell that begins where the box ends is not in the way: its obstacle is farther than D_min.
      if (near_face_m < box_.size_m.x() - kTouch_m) {
        clear_distance_m_ = std::min(clear_distance_m_, std::max(0.0, near_face_m));
      }
    }
    const bool inside = centre_F.x() >= blind_m_ && centre_F.x() <= box_.size_m.x() &&
                        2.0 * std::abs(centre_F.y()) <= box_.size_m.y() &&
                        2.0 * std::abs(centre_F.z()) <= box_.size_m.z();
    if (!inside || !observable_(centre_M)) return;
    ++observable_cells_;
    unknown_cells_ += !node;
  }

  const octomap::OcTree& tree_;
  const Box& box_;
  double blind_m_;
  const Observable& observable_;
  Eigen::Isometry3d T_F_M_;
  double clear_distance_m_ = kInfinity;
  long observable_cells_ = 0;
  long unknown_cells_ = 0;
};

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
  rules.require(0.0 <= config.hold_s && config.hold_s <= 10.0, "hold_s", "0 to 10", config.hold_s);
  rules.require(config.max_age_s > 0.0, "max_age_s", "positive", config.max_age_s);
  return rules.broken();
}

/// Projections of both bodies overlap on every candidate axis: 3 of the cube, 3 of the box, 9 cross products.
bool intersects(const Box& box, const Eigen::Vector3d& cube_centre_M, double cube_edge_m) {
  const Eigen::Matrix3d& R = box.T_M_F.linear();
  const Eigen::Vector3d half = 0.5 * box.size_m;
  const Eigen::Vector3d box_centre_M = box.T_M_F * Eigen::Vector3d(half.x(), 0.0, 0.0);
  const Eigen::Vector3d between_M = cube_centre_M - box_centre_M;
  const auto overlap = [&](const Eigen::Vector3d& axis_M) {
    const double cube_reach = 0.5 * cube_edge_m * axis_M.lpNorm<1>();
    const double box_reach = (R.transpose() * axis_M).cwiseAbs().dot(half);
    return std::abs(axis_M.dot(between_M)) <= cube_reach + box_reach + kTouch_m;
  };
  for (int i = 0; i < 3; ++i) {
    if (!overlap(Eigen::Vector3d::Unit(i)) || !overlap(R.col(i))) return false;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (!overlap(Eigen::Vector3d::Unit(i).cross(R.col(j)))) return false;
    }
  }
  return true;
}

Corridor::Corridor(const CorridorConfig& config) : config_(config) { throwIfBroken(check(config)); }

Box Corridor::box(const Eigen::Isometry3d& T_M_F) const {
  Box box;
  box.T_M_F = T_M_F * Eigen::Translation3d(config_.offset_m);
  const double margin = config_.margin_m;
  box.size_m = {config_.length_m + margin, config_.width_m + 2.0 * margin, config_.height_m + 2.0 * margin};
  return box;
}

CorridorOccupancy Corridor::inspect(const octomap::OcTree& tree, const Box& box,
                                    const std::function<bool(const Eigen::Vector3d&)>& observable) const {
  return Inspection(tree, box, config_.blind_m, observable).run();
}

}  // namespace flight_corridor
