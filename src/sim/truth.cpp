#include "sim/truth.hpp"

#include <Eigen/QR>
#include <algorithm>

#include "sim/rig.hpp"

namespace flight_corridor::sim {
namespace {

constexpr double kBorder_m = 0.10;  // nearer to the box's sides than this, a frame is not scored
constexpr double kTouching_m = 1e-6;
constexpr double kNoWeight = 1e-12;
constexpr int kMaxIterations = 100;  // touching shapes converge slowly; all others need about ten
constexpr int kBisections = 22;      // 4 m / 2^22 = 1e-6 m

Eigen::Vector3d cornerTowards(const Eigen::Vector3d& direction, const Eigen::Vector3d& half_m) {
  return (direction.array() >= 0.0).select(half_m, -half_m);
}

/// Farthest point of a primitive in a direction, both in O.
Eigen::Vector3d support(const Primitive& primitive, const Eigen::Vector3d& direction_O) {
  const double radius_m = primitive.half_m.x();
  switch (primitive.shape) {
    case Shape::Box:
      break;
    case Shape::Cylinder: {
      const Eigen::Vector3d radial(direction_O.x(), direction_O.y(), 0.0);
      const double end_z = direction_O.z() >= 0.0 ? primitive.half_m.z() : -primitive.half_m.z();
      return radius_m * radial.stableNormalized() + end_z * Eigen::Vector3d::UnitZ();
    }
    case Shape::Sphere:
    case Shape::Foliage:
      return radius_m * direction_O.stableNormalized();
  }
  return cornerTowards(direction_O, primitive.half_m);
}

/// At most four points and the weights that make their nearest combination to the origin.
class Simplex {
 public:
  Eigen::Vector3d nearest() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < points_.size(); ++i) sum += weights_[i] * points_[i];
    return sum;
  }

  /// Takes a point in and drops those that the new nearest combination does without (Wolfe 1976, minor cycle).
  void add(const Eigen::Vector3d& point) {
    points_.push_back(point);
    weights_.push_back(points_.size() == 1 ? 1.0 : 0.0);
    for (;;) {
      const std::vector<double> target = nearestOnFlat();
      if (*std::min_element(target.begin(), target.end()) > kNoWeight) {
        weights_ = target;
        return;
      }
      moveTowards(target);
      dropWeightless();
    }
  }

 private:
  /// Weights, of any sign, of the point nearest to the origin on the flat through all points.
  std::vector<double> nearestOnFlat() const {
    const std::size_t edges = points_.size() - 1;
    std::vector<double> weights(points_.size(), 1.0);
    if (edges == 0) return weights;
    Eigen::Matrix<double, 3, Eigen::Dynamic> directions(3, edges);
    for (std::size_t i = 0; i < edges; ++i) directions.col(i) = points_[i + 1] - points_[0];
    const Eigen::VectorXd solution = directions.colPivHouseholderQr().solve(-points_[0]);
    for (std::size_t i = 0; i < edges; ++i) weights[i + 1] = solution[i];
    weights[0] = 1.0 - solution.sum();
    return weights;
  }

  /// As far as all weights stay positive.
  void moveTowards(const std::vector<double>& target) {
    double share = 1.0;
    for (std::size_t i = 0; i < target.size(); ++i) {
      if (target[i] <= kNoWeight) share = std::min(share, weights_[i] / std::max(weights_[i] - target[i], kNoWeight));
    }
    for (std::size_t i = 0; i < target.size(); ++i) weights_[i] += share * (target[i] - weights_[i]);
  }

  void dropWeightless() {
    const auto lightest = std::min_element(weights_.begin(), weights_.end());
    points_.erase(points_.begin() + (lightest - weights_.begin()));
    weights_.erase(lightest);
  }

  std::vector<Eigen::Vector3d> points_;
  std::vector<double> weights_;
};

/// The Minkowski difference {p_box - p_primitive}, in B, the box's middle.
class Difference {
 public:
  Difference(const Eigen::Isometry3d& T_W_F, const Eigen::Vector3d& size_m, const Primitive& primitive)
      : half_m_(size_m / 2.0),
        primitive_(primitive),
        T_B_O_((T_W_F * Eigen::Translation3d(half_m_.x(), 0.0, 0.0)).inverse() * primitive.T_W_O) {}

  Eigen::Vector3d farthest(const Eigen::Vector3d& direction) const {
    return cornerTowards(direction, half_m_) - T_B_O_ * support(primitive_, -(T_B_O_.linear().transpose() * direction));
  }

  /// Its point nearest to the origin, as far as that is needed.
  /// @param suffices whether, with the nearest point so far and the farthest towards the origin, enough is known.
  template <typename Suffices>
  Eigen::Vector3d nearest(const Suffices& suffices) const {
    Simplex simplex;
    simplex.add(farthest(T_B_O_.translation()));
    for (int i = 0; i < kMaxIterations && simplex.nearest().norm() >= kTouching_m; ++i) {
      const Eigen::Vector3d next = farthest(-simplex.nearest());
      if (suffices(simplex.nearest(), next)) break;
      simplex.add(next);
    }
    return simplex.nearest();
  }

 private:
  Eigen::Vector3d half_m_;
  const Primitive& primitive_;
  Eigen::Isometry3d T_B_O_;
};

}  // namespace

bool overlaps(const Eigen::Isometry3d& T_W_F, const Eigen::Vector3d& size_m, const Primitive& primitive) {
  bool plane_between = false;
  Difference(T_W_F, size_m, primitive).nearest([&](const Eigen::Vector3d& nearest, const Eigen::Vector3d& next) {
    return plane_between = nearest.dot(next) > 0.0;
  });
  return !plane_between;
}

/// The plane across the nearest point through the farthest towards the origin is a lower bound.
double gapBetween(const Eigen::Isometry3d& T_W_F, const Eigen::Vector3d& size_m, const Primitive& primitive) {
  constexpr double kExact_m = 1e-3;
  const auto is_exact = [](const Eigen::Vector3d& nearest, const Eigen::Vector3d& next) {
    return nearest.norm() - nearest.normalized().dot(next) < kExact_m;
  };
  return Difference(T_W_F, size_m, primitive).nearest(is_exact).norm();
}

double clearDistance(const std::vector<Primitive>& primitives, const Eigen::Isometry3d& T_W_F,
                     const Eigen::Vector3d& size_m) {
  double clear_m = kInfinity;
  for (const Primitive& primitive : primitives) {
    double blocked_m = std::min(clear_m, size_m.x());
    const auto blockedAt = [&](double length_m) {
      return overlaps(T_W_F, {length_m, size_m.y(), size_m.z()}, primitive);
    };
    if (!blockedAt(blocked_m)) continue;
    double free_m = 0.0;
    for (int i = 0; i < kBisections; ++i) {
      const double middle_m = (free_m + blocked_m) / 2.0;
      (blockedAt(middle_m) ? blocked_m : free_m) = middle_m;
    }
    clear_m = blocked_m;
  }
  return clear_m;
}

CorridorTruth corridorTruth(const std::vector<Primitive>& primitives, const Eigen::Isometry3d& T_W_C,
                            const Eigen::Vector3d& corridor_m) {
  Eigen::Isometry3d T_W_F = T_W_C;
  T_W_F.linear() = T_W_C.linear() * forwardFromOptical().transpose();
  const Eigen::Vector3d border_m(kBorder_m, 2.0 * kBorder_m, 2.0 * kBorder_m);
  return {clearDistance(primitives, T_W_F, corridor_m), clearDistance(primitives, T_W_F, corridor_m - border_m),
          clearDistance(primitives, T_W_F, corridor_m + border_m)};
}

}  // namespace flight_corridor::sim
