#include "sim/world.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace flight_corridor::sim {
namespace {

/// Part of a ray inside a convex solid: the parts inside each of its slabs and rounds, intersected.
struct Passage {
  float enter = -std::numeric_limits<float>::infinity();
  float leave = std::numeric_limits<float>::infinity();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();

  void miss() { leave = -std::numeric_limits<float>::infinity(); }
};

void clipBySlab(int axis, float half_m, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                Passage& passage) {
  if (direction[axis] == 0.0f) {
    if (std::abs(origin[axis]) > half_m) passage.miss();
    return;
  }
  const float inverse = 1.0f / direction[axis];
  const float side = inverse > 0.0f ? -1.0f : 1.0f;
  const float enter = (side * half_m - origin[axis]) * inverse;
  passage.leave = std::min(passage.leave, (-side * half_m - origin[axis]) * inverse);
  if (enter > passage.enter) {
    passage.enter = enter;
    passage.normal = side * Eigen::Vector3f::Unit(axis);
  }
}

/// Round about the origin: a sphere, or, of a ray without its part along an axis, a cylinder along that axis.
void clipByRound(float radius_m, const Eigen::Vector3f& o, const Eigen::Vector3f& d, Passage& passage) {
  const float squared_speed = d.squaredNorm();
  // From the nearest point of the line, not by the textbook's b^2 - 4ac: that cancels for thin poles far away.
  const float t_nearest = squared_speed > 0.0f ? -o.dot(d) / squared_speed : 0.0f;
  const float squared_half_chord = radius_m * radius_m - (o + t_nearest * d).squaredNorm();
  if (squared_half_chord < 0.0f) return passage.miss();
  if (squared_speed == 0.0f) return;
  const float half_passage = std::sqrt(squared_half_chord / squared_speed);
  passage.leave = std::min(passage.leave, t_nearest + half_passage);
  if (const float enter = t_nearest - half_passage; enter > passage.enter) {
    passage.enter = enter;
    passage.normal = (o + enter * d) / radius_m;
  }
}

/// Random bits of a cell of foliage.
std::uint32_t cellBits(const Eigen::Vector3i& cell, std::uint32_t seed) {
  const Eigen::Matrix<std::uint32_t, 3, 1> c = cell.cast<std::uint32_t>();
  std::uint32_t h = c.x() * 0x8da6b343u + c.y() * 0xd8163841u + c.z() * 0xcb1ab31fu + seed;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  return h ^ (h >> 13);
}

/// A leaf: a round disc in the middle of a cell of edge 1, turned anyhow.
/// @param origin, direction  from the cell's middle.
std::optional<SurfacePoint> meetLeaf(std::uint32_t bits, const Eigen::Vector3f& origin,
                                     const Eigen::Vector3f& direction) {
  const auto signedByte = [&](int shift) { return static_cast<float>(bits >> shift & 0xffu) - 127.5f; };
  Eigen::Vector3f normal(signedByte(0), signedByte(8), signedByte(16));
  const float slope = normal.dot(direction);
  const float t = -normal.dot(origin) / slope;  // not finite: seen from the edge
  if (!(0.0f < t) || !((origin + t * direction).squaredNorm() < 0.25f)) return std::nullopt;
  return SurfacePoint{t, normal.normalized() * (slope > 0.0f ? -1.0f : 1.0f)};
}

/// The first leaf in the cells of a grid in which a ray passes a sphere, one after the other (Amanatides and Woo 1987).
std::optional<SurfacePoint> meetLeaves(const Primitive& foliage, const Passage& passage,
                                       const Eigen::Vector3f& origin_O, const Eigen::Vector3f& direction_O) {
  constexpr float kCellsInRadius = 4.0f;
  constexpr std::uint32_t kBare = 0x50000000u;  // of 2^32: share of cells without a leaf
  if (!(passage.enter <= passage.leave) || passage.leave <= 0.0f) return std::nullopt;
  const float per_m = kCellsInRadius / static_cast<float>(foliage.half_m.x());
  const Eigen::Vector3f origin = per_m * origin_O, direction = per_m * direction_O;
  const Eigen::Vector3f start = origin + std::max(passage.enter, 0.0f) * direction;
  Eigen::Vector3i cell = start.array().floor().cast<int>();
  const Eigen::Vector3i step = (direction.array() < 0.0f).select(Eigen::Array3i::Constant(-1), 1);
  const Eigen::Vector3f per_cell = direction.cwiseAbs().cwiseInverse();
  const Eigen::Array3f border =
      cell.cast<float>().array() + (direction.array() < 0.0f).select(Eigen::Array3f::Zero(), 1);
  // Where the ray leaves the cell; infinite, and never negative, along axes that it does not move on.
  Eigen::Vector3f t_border = (border - origin.array()) * step.array().cast<float>() * per_cell.array();
  for (float t = 0.0f; t < passage.leave;) {
    const Eigen::Vector3f middle = cell.cast<float>().array() + 0.5f;
    const std::uint32_t bits = cellBits(cell, foliage.material.seed);
    const bool is_leafy = bits >= kBare && middle.norm() < kCellsInRadius - 0.5f;  // the whole leaf lies in the sphere
    if (is_leafy) {
      if (auto leaf = meetLeaf(bits, origin - middle, direction)) return leaf;
    }
    int axis = 0;
    t = t_border.minCoeff(&axis);
    cell[axis] += step[axis];
    t_border[axis] += per_cell[axis];
  }
  return std::nullopt;
}

}  // namespace

Primitive makeBox(const Eigen::Vector3d& centre_W, const Eigen::Vector3d& size_m, const Material& material) {
  Primitive box;
  box.T_W_O.translation() = centre_W;
  box.half_m = size_m / 2.0;
  box.material = material;
  return box;
}

Primitive makeCylinder(const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W, double radius_m,
                       const Material& material) {
  Primitive cylinder;
  cylinder.shape = Shape::Cylinder;
  cylinder.T_W_O.linear() =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), to_W - from_W).toRotationMatrix();
  cylinder.T_W_O.translation() = (from_W + to_W) / 2.0;
  cylinder.half_m = {radius_m, radius_m, (to_W - from_W).norm() / 2.0};
  cylinder.material = material;
  return cylinder;
}

Primitive makeSphere(const Eigen::Vector3d& centre_W, double radius_m, const Material& material) {
  Primitive sphere = makeBox(centre_W, Eigen::Vector3d::Constant(2.0 * radius_m), material);
  sphere.shape = Shape::Sphere;
  return sphere;
}

Primitive makeFoliage(const Eigen::Vector3d& centre_W, double radius_m, const Material& material) {
  Primitive foliage = makeSphere(centre_W, radius_m, material);
  foliage.shape = Shape::Foliage;
  return foliage;
}

std::vector<Primitive> visibleAt(const std::vector<Primitive>& world, double time_s) {
  std::vector<Primitive> visible;
  for (const Primitive& primitive : world) {
    if (time_s < primitive.visible_from_s || primitive.visible_until_s <= time_s) continue;
    visible.push_back(primitive);
    visible.back().T_W_O.translation() += time_s * primitive.velocity_W;
  }
  return visible;
}

std::optional<SurfacePoint> intersect(const Primitive& primitive, const Eigen::Vector3f& origin_O,
                                      const Eigen::Vector3f& direction_O) {
  const Eigen::Vector3f half_m = primitive.half_m.cast<float>();
  Passage passage;
  switch (primitive.shape) {
    case Shape::Box:
      for (int axis = 0; axis < 3; ++axis) clipBySlab(axis, half_m[axis], origin_O, direction_O, passage);
      break;
    case Shape::Cylinder:
      clipByRound(half_m.x(), {origin_O.x(), origin_O.y(), 0.0f}, {direction_O.x(), direction_O.y(), 0.0f}, passage);
      clipBySlab(2, half_m.z(), origin_O, direction_O, passage);
      break;
    case Shape::Sphere:
      clipByRound(half_m.x(), origin_O, direction_O, passage);
      break;
    case Shape::Foliage:
      clipByRound(half_m.x(), origin_O, direction_O, passage);
      return meetLeaves(primitive, passage, origin_O, direction_O);
  }
  if (!(0.0f < passage.enter && passage.enter <= passage.leave)) return std::nullopt;
  return SurfacePoint{passage.enter, passage.normal};
}

}  // namespace flight_corridor::sim
