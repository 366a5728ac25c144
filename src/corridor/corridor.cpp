#include "flight_corridor/corridor/corridor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace flight_corridor {

namespace {

constexpr double kFarShare = 0.25;        // of a corridor's length: its end
constexpr double kEndInView = 2.0 / 3.0;  // of its cells; with fewer in view all must be known
constexpr double kRounding_m = 1e-9;      // centres that rounding puts outside of the plane that they lie on are inside

using Node = octomap::OcTreeNode;

/// A cube of the octree's space and what the tree knows of it.
struct Cube {
  const Node* node;  // its own, that of a pruned cube around it, or null: unknown
  Eigen::Vector3d centre_M;
  unsigned depth;  // 0 = all of the tree's space
};

Cube root(const octomap::OcTree& tree) { return {tree.getRoot(), Eigen::Vector3d::Zero(), 0}; }

/// Where an eighth of a cube lies, in half edges from the cube's centre: OctoMap's bits 0 to 2 are set in the upper
/// halves along x, y, z.
Eigen::Vector3d corner(unsigned child) {
  return {child & 1u ? 1.0 : -1.0, child & 2u ? 1.0 : -1.0, child & 4u ? 1.0 : -1.0};
}

/// What the tree knows of an eighth of a cube.
const Node* part(const octomap::OcTree& tree, const Node* node, unsigned child) {
  if (!node || !tree.nodeHasChildren(node)) return node;
  return tree.nodeChildExists(node, child) ? tree.getNodeChild(node, child) : nullptr;
}

Cube part(const octomap::OcTree& tree, const Cube& cube, unsigned child) {
  const double half_edge_m = 0.5 * tree.getNodeSize(cube.depth + 1);
  return {part(tree, cube.node, child), cube.centre_M + half_edge_m * corner(child), cube.depth + 1};
}

/// Depth-first search for the occupied cell in a box that is nearest along the box's axis.
class NearestObstacle {
 public:
  NearestObstacle(const octomap::OcTree& tree, const Box& box, const CellBegin& begin)
      : tree_(tree), box_(box), begin_(begin), forward_M_(box.T_M_F.linear().col(0)) {
    for (unsigned axis = 0; axis < 3; ++axis) nearest_child_ |= (forward_M_[axis] < 0.0 ? 1u : 0u) << axis;
    visit(root(tree));
  }

  double clearDistance() const { return clear_distance_m_; }

 private:
  /// Inner nodes are as occupied as their most occupied leaf.
  void visit(const Cube& cube) {
    if (!cube.node || !tree_.isNodeOccupied(cube.node)) return;
    const double edge_m = tree_.getNodeSize(cube.depth);
    const double near_face_m =
        forward_M_.dot(cube.centre_M - box_.T_M_F.translation()) - 0.5 * edge_m * forward_M_.lpNorm<1>();
    // A cell that begins where the box ends is not in the way: its obstacle is farther than D_min.
    if (near_face_m >= box_.size_m.x() - kTouch_m || std::max(0.0, near_face_m) >= clear_distance_m_) return;
    if (!intersects(box_, cube.centre_M, edge_m)) return;
    if (cube.depth == tree_.getTreeDepth()) {
      const double near_m = std::max(0.0, near_face_m);
      clear_distance_m_ = std::min(clear_distance_m_, begin_ ? begin_(cube.centre_M, near_m) : near_m);
      return;
    }
    for (unsigned child = 0; child < 8; ++child) visit(part(tree_, cube, child ^ nearest_child_));
  }

  const octomap::OcTree& tree_;
  const Box& box_;
  const CellBegin& begin_;
  Eigen::Vector3d forward_M_;
  unsigned nearest_child_ = 0;
  double clear_distance_m_ = kInfinity;
};

/// Cells of a region, and how many of them are unknown.
struct Cells {
  std::int64_t all = 0, unknown = 0;
};

Cells operator+(const Cells& one, const Cells& other) { return {one.all + other.all, one.unknown + other.unknown}; }

double unknownFraction(const Cells& cells) {
  return cells.all > 0 ? static_cast<double>(cells.unknown) / static_cast<double>(cells.all) : 1.0;
}

/// Counts the cells centred in a convex region, cubes of them at once where all or none are.
class CellCount {
 public:
  CellCount(const octomap::OcTree& tree, const ConvexRegion& region_M) : tree_(tree) {
    const auto planes = static_cast<std::size_t>(region_M.cols());
    for (std::size_t i = 0; i < planes; ++i) planes_[i] = Plane(region_M.col(static_cast<Eigen::Index>(i)));
    visit(root(tree), planes);
  }

  const Cells& cells() const { return cells_; }

 private:
  struct Plane {
    Plane() = default;
    explicit Plane(const Eigen::Vector4d& plane_M)
        : normal_M(plane_M.head<3>()), offset_m(plane_M[3] + kRounding_m), spread(normal_M.lpNorm<1>()) {
      for (unsigned child = 0; child < 8; ++child) step[child] = normal_M.dot(corner(child));
    }

    Eigen::Vector3d normal_M;  // inwards
    double offset_m;
    double spread;               // half edges that a cube reaches inwards from its centre
    std::array<double, 8> step;  // half edges, its own, that each eighth lies farther inwards than its cube
  };

  /// Where the cells of a cube's eighths are centred. Bit sets; what is in neither is wholly inside.
  struct Parts {
    unsigned outside = 0, divided = 0;
  };

  /// @param undecided so many of the first planes may divide the cube's cells; the order among them is free.
  void visit(const Cube& cube, std::size_t undecided) {
    const Parts parts = judge(cube, undecided);
    for (unsigned child = 0; child < 8; ++child) {
      if (parts.outside >> child & 1u) continue;
      if (parts.divided >> child & 1u) {
        visit(part(tree_, cube, child), undecided);
      } else {
        count(part(tree_, cube.node, child), cube.depth + 1);
      }
    }
  }

  /// @param undecided less by the planes that all of the cube's cells are inside of.
  Parts judge(const Cube& cube, std::size_t& undecided) {
    const double half_edge_m = 0.5 * tree_.getNodeSize(cube.depth), half_cell_m = 0.5 * tree_.getResolution();
    const double part_half_edge_m = 0.5 * half_edge_m;
    Parts parts;
    for (std::size_t i = 0; i < undecided;) {
      const Plane& plane = planes_[i];
      const double distance_m = plane.normal_M.dot(cube.centre_M) + plane.offset_m;
      if (distance_m >= (half_edge_m - half_cell_m) * plane.spread) {
        std::swap(planes_[i], planes_[--undecided]);
        continue;
      }
      const double part_reach_m = (part_half_edge_m - half_cell_m) * plane.spread;
      for (unsigned child = 0; child < 8; ++child) {
        const double part_distance_m = distance_m + part_half_edge_m * plane.step[child];
        parts.outside |= static_cast<unsigned>(!(part_distance_m >= -part_reach_m)) << child;
        parts.divided |= static_cast<unsigned>(part_distance_m < part_reach_m) << child;
      }
      ++i;
    }
    return parts;
  }

  /// All cells of a cube.
  void count(const Node* node, unsigned depth) {
    if (node && tree_.nodeHasChildren(node)) {
      for (unsigned child = 0; child < 8; ++child) count(part(tree_, node, child), depth + 1);
      return;
    }
    const std::int64_t cells = std::int64_t{1} << 3 * (tree_.getTreeDepth() - depth);
    cells_.all += cells;
    if (!node) cells_.unknown += cells;
  }

  const octomap::OcTree& tree_;
  std::array<Plane, kMostPlanes> planes_;
  Cells cells_;
};

bool isWithin(const octomap::OcTree& tree, const Box& box) {
  const Eigen::Vector3d reach_M = 0.5 * (box.T_M_F.linear().cwiseAbs() * box.size_m);
  return ((centre(box).cwiseAbs() + reach_M).array() <= 0.5 * tree.getNodeSize(0)).all();
}

/// Those of a box that are centred in a region, too; none when the box reaches out of the octree.
Cells cellsIn(const octomap::OcTree& tree, const Box& box, const ConvexRegion& region_M) {
  return isWithin(tree, box) ? CellCount(tree, intersection(inside(box), region_M)).cells() : Cells();
}

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
  rules.require(config.max_age_s > 0.0, "max_age_s", "positive", config.max_age_s);
  return rules.broken();
}

CorridorOccupancy inspectBox(const octomap::OcTree& tree, const Box& box, const ConvexRegion& needed_M,
                             const CellBegin& begin) {
  CorridorOccupancy occupancy;
  occupancy.clear_distance_m = NearestObstacle(tree, box, begin).clearDistance();
  occupancy.unknown_fraction = unknownFraction(cellsIn(tree, box, needed_M));
  return occupancy;
}

Corridor::Corridor(const CorridorConfig& config) : config_(config) { throwIfBroken(check(config)); }

Box Corridor::box(const Eigen::Isometry3d& T_M_F) const {
  Box box;
  box.T_M_F = T_M_F * Eigen::Translation3d(config_.offset_m);
  const double margin = config_.margin_m;
  box.size_m = {config_.length_m + margin, config_.width_m + 2.0 * margin, config_.height_m + 2.0 * margin};
  return box;
}

CorridorOccupancy Corridor::inspect(const octomap::OcTree& tree, const Box& box, const Eigen::Vector3d& camera_M,
                                    const ConvexRegion& observable_M, const CellBegin& begin) const {
  const double needed_from_m = (box.T_M_F.inverse() * camera_M).x() + config_.blind_m;  // along the box's axis
  const ConvexRegion far_M = beyond(box, std::max(needed_from_m, (1.0 - kFarShare) * box.size_m.x()));
  const ConvexRegion nearer_M = -far_M - 2.0 * kRounding_m * Eigen::Vector4d::UnitW();  // no cell is in both
  const ConvexRegion needed_M = intersection(observable_M, beyond(box, needed_from_m));
  const Cells end = cellsIn(tree, box, far_M), end_in_view = cellsIn(tree, box, intersection(observable_M, far_M));
  const bool shows_end = static_cast<double>(end_in_view.all) >= kEndInView * static_cast<double>(end.all);
  CorridorOccupancy occupancy;
  occupancy.clear_distance_m = NearestObstacle(tree, box, begin).clearDistance();
  occupancy.unknown_fraction =
      unknownFraction(cellsIn(tree, box, intersection(needed_M, nearer_M)) + (shows_end ? end_in_view : end));
  return occupancy;
}

}  // namespace flight_corridor
