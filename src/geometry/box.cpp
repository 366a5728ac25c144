#include "flight_corridor/geometry/box.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flight_corridor {

namespace {

constexpr double kLongest_m = 100.0;    // side of a box, as of the configured corridor
constexpr double kLargest_cells = 1e6;  // on a box's surface: these are what counting costs, up to about 20 ms

}  // namespace

Violations check(const Box& box, double cell_m) {
  Rules rules("box");
  const Eigen::Vector3d start_M = box.T_M_F.translation();
  const char* const kSides[] = {"length_m", "width_m", "height_m"};
  for (int axis = 0; axis < 3; ++axis) {
    rules.require(std::isfinite(start_M[axis]), "position", "finite", start_M[axis]);
    rules.require(0.0 < box.size_m[axis] && box.size_m[axis] <= kLongest_m, kSides[axis], "above 0, up to 100",
                  box.size_m[axis]);
  }
  rules.require(isRotation(box.T_M_F.linear()), "orientation", "a rotation", box.T_M_F.linear().determinant());
  const Eigen::Vector3d others_m(box.size_m.y(), box.size_m.z(), box.size_m.x());
  const double surface_m2 = 2.0 * box.size_m.dot(others_m);
  const double surface_cells = surface_m2 / (cell_m * cell_m);
  rules.require(surface_cells <= kLargest_cells, "surface", "up to 1000000 of the map's cells", surface_cells);
  return rules.broken();
}

bool isRotation(const Eigen::Matrix3d& R, double tolerance) { return R.isUnitary(tolerance) && R.determinant() > 0.0; }

Eigen::Vector3d centre(const Box& box) { return box.T_M_F * Eigen::Vector3d(0.5 * box.size_m.x(), 0.0, 0.0); }

bool contains(const Box& box, const Eigen::Vector3d& point_M) {
  return contains(box.size_m, box.T_M_F.inverse() * point_M);
}

bool contains(const Eigen::Vector3d& size_m, const Eigen::Vector3d& point_F) {
  return 0.0 <= point_F.x() && point_F.x() < size_m.x() && 2.0 * std::abs(point_F.y()) <= size_m.y() &&
         2.0 * std::abs(point_F.z()) <= size_m.z();
}

/// Projections of both bodies overlap on every candidate axis: 3 of the cube, 3 of the box, 9 cross products.
bool intersects(const Box& box, const Eigen::Vector3d& cube_centre_M, double cube_edge_m) {
  const Eigen::Matrix3d& R = box.T_M_F.linear();
  const Eigen::Vector3d half = 0.5 * box.size_m;
  const Eigen::Vector3d between_M = cube_centre_M - centre(box);
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

/// Slabs (Kay and Kajiya 1986): a ray is in the box where it is between all three pairs of sides.
Crossing crossing(const Eigen::Isometry3d& T_F_M, const Eigen::Vector3d& size_m, const Eigen::Vector3d& direction_M) {
  const Eigen::Array3d low(0.0, -0.5 * size_m.y(), -0.5 * size_m.z()), high(size_m.x(), -low.y(), -low.z());
  const Eigen::Array3d start = T_F_M.translation(), along = T_F_M.linear() * direction_M;
  const Eigen::Array3d one = (low - start) / along, other = (high - start) / along;  // NaN along a side
  return {one.min(other).maxCoeff(), one.max(other).minCoeff()};
}

double farthestCorner(const Box& box) {
  return centre(box).z() + 0.5 * box.T_M_F.linear().row(2).cwiseAbs().dot(box.size_m);
}

double nearestCorner(const Box& box) {
  return centre(box).z() - 0.5 * box.T_M_F.linear().row(2).cwiseAbs().dot(box.size_m);
}

}  // namespace flight_corridor
