#pragma once

#include <Eigen/Geometry>
#include <string>

#include "flight_corridor/motion/visual_odometry.hpp"

namespace flight_corridor {

/// A way that the camera went, once as told and once as its images show it, in the camera of its start.
struct Way {
  double duration_s = 0.0;
  Eigen::Vector3d told_m = Eigen::Vector3d::Zero(), seen_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d told_rad = Eigen::Vector3d::Zero(), seen_rad = Eigen::Vector3d::Zero();  ///< Rotation vectors.
};

/// In words: both motions, and what the difference is likely of.
std::string describe(const Way& way);

/// Compares told motion with that of the images. The images' depends on the calibration: a focal length of another
/// image changes its turns, a shifted principal point its direction, a wrong baseline its length; a wrong mounting in
/// tf turns all of it. What was told may be wrong itself. One object, one thread.
class MotionWitness {
 public:
  /// Whether told and seen motion differ by more than three sigma.
  /// @param told_S_C, seen pose at a way's end in the camera of its start.
  static bool disagrees(double duration_s, const Eigen::Isometry3d& told_S_C, const RelativePose& seen);

  /// A finished way, likewise.
  void add(double duration_s, const Eigen::Isometry3d& told_S_C, const RelativePose& seen);

  /// Whether a way is long, or turns enough.
  static bool isComparable(const Eigen::Isometry3d& T_S_C);

  /// The last two ways that were long enough to be compared disagree, each by more than three sigma.
  bool contradicts() const { return disagreeing_ >= kInSuccession; }
  /// The last way that disagreed.
  const Way& way() const { return way_; }

  void forget() { disagreeing_ = 0; }

 private:
  static constexpr int kInSuccession = 2;  // ways that disagree

  int disagreeing_ = 0;  // ways in succession
  Way way_;
};

}  // namespace flight_corridor
