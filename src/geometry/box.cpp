#include "flight_corridor/geometry/box.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "flight_corridor/parameter.hpp"

namespace flight_corridor {

namespace {

constexpr double kLongest_m = 100.0;    // side of a box, as of the configured corridor
constexpr double kLargest_cells = 1e6;  // on a box's surface: these are what counting costs, up to about 20 ms

}  // namespace

Violations check(const Box& box, double cell_m) {
  Eigen::Vector3d start_M = box.T_M_F.translation(), size_m = box.size_m;
  const Eigen::Matrix3d R_M_F = box.T_M_F.linear();
  double determinant = R_M_F.determinant();
  double surface_cells = 2.0 * size_m.dot(Eigen::Vector3d(size_m.y(), size_m.z(), size_m.x())) / (cell_m * cell_m);
  const char* const kSides[] = {"box/length_m", "box/width_m", "box/height_m"};
  Parameters parameters;
  for (int axis = 0; axis < 3; ++axis) {
    parameters.push_back({"box/position", &start_M[axis], Rule().where(std::isfinite(start_M[axis]), "finite")});
    parameters.push_back({kSides[axis], &size_m[axis], above(0).upTo(kLongest_m)});
  }
  parameters.push_back({"box/orientation", &determinant, Rule().where(isRotation(R_M_F), "a rotation")});
  parameters.push_back({"box/surface", &surface_cells,
                        Rule().where(surface_cells <= kLargest_cells, "up to 1000000 of the map's cells")});
  return brokenRules(parameters);
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
