#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "flight_corridor/geometry/box.hpp"

namespace flight_corridor {

/// One box in a grid of directions: turned about its start, to the left by a yaw first, then up by a pitch. Row by row:
/// the first pitch first. A box is a fan of one.
class Fan {
 public:
  Fan(const Box& box_C) : Fan(box_C, {0.0}, {0.0}) {}  // NOLINT(google-explicit-constructor)
  Fan(const Box& box_C, const std::vector<double>& yaws_rad, const std::vector<double>& pitches_rad);

  int size() const { return static_cast<int>(yaws_.size() * pitches_.size()); }
  Box box(int direction) const;
  /// Straight ahead.
  const Box& box() const { return box_C_; }
  /// Of all boxes' corners, along z of C [m].
  double farthestCorner() const;
  /// Turns points of C into the frame of box().
  const Eigen::Isometry3f& T_F_C() const { return T_F_C_; }

  /// A point in the frame of a direction's box.
  Eigen::Vector3f turned(int direction, const Eigen::Vector3f& point_F) const {
    const int columns = static_cast<int>(yaws_.size());
    return pitched(pitches_[direction / columns], yawed(yaws_[direction % columns], point_F));
  }

  /// Calls visit(direction, point in the frame of its box) for each box that holds a point, or has it within beside_m
  /// of its sides and end.
  template <class Visit>
  void visit(const Eigen::Vector3f& point_F, float beside_m, Visit&& visit) const {
    const Eigen::Vector3f half_m = half_m_.array() + beside_m;
    const float end_m = end_m_ + beside_m;
    const int columns = static_cast<int>(yaws_.size()), rows = static_cast<int>(pitches_.size());
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector3f yawed_F = yawed(yaws_[column], point_F);
      if (std::abs(yawed_F.y()) > half_m.y()) continue;
      for (int row = 0; row < rows; ++row) {
        const Eigen::Vector3f point = pitched(pitches_[row], yawed_F);
        const bool is_in = std::abs(point.z()) <= half_m.z() && 0.0f <= point.x() && point.x() < end_m;
        if (is_in) visit(row * columns + column, point);
      }
    }
  }

  /// Whether a direction's box holds a point in its frame.
  bool contains(const Eigen::Vector3f& point) const {
    return std::abs(point.y()) <= half_m_.y() && std::abs(point.z()) <= half_m_.z() && 0.0f <= point.x() &&
           point.x() < end_m_;
  }

  bool operator==(const Fan& other) const;

 private:
  struct Turn {
    double angle_rad;
    float cos, sin;
    bool operator==(const Turn& other) const { return angle_rad == other.angle_rad; }
  };
  static std::vector<Turn> turns(const std::vector<double>& angles_rad);
  static Eigen::Vector3f yawed(const Turn& yaw, const Eigen::Vector3f& p) {
    return {yaw.cos * p.x() + yaw.sin * p.y(), yaw.cos * p.y() - yaw.sin * p.x(), p.z()};
  }
  static Eigen::Vector3f pitched(const Turn& pitch, const Eigen::Vector3f& p) {
    return {pitch.cos * p.x() + pitch.sin * p.z(), p.y(), pitch.cos * p.z() - pitch.sin * p.x()};
  }

  Box box_C_;
  Eigen::Isometry3f T_F_C_;
  std::vector<Turn> yaws_, pitches_;
  Eigen::Vector3f half_m_;
  float end_m_;
};

}  // namespace flight_corridor
