#pragma once

#include <Eigen/Geometry>
#include <deque>
#include <optional>
#include <vector>

#include "flight_corridor/corridor/box_patches.hpp"
#include "flight_corridor/geometry/fan.hpp"
#include "flight_corridor/motion/camera_motion.hpp"

namespace flight_corridor {

/// Obstacles of the last moments that images may miss, where they stood: single images miss thin and small ones now and
/// then, and noise moves what stands at a box's edge in and out. One object, one thread.
class RecentObstacles {
 public:
  /// A pair, not older than the last.
  /// @param pose absent: nobody knows where earlier obstacles are now.  @param hold_s they are forgotten after that.
  void moveTo(double stamp_s, const std::optional<CameraPose>& pose, double hold_s);

  /// What of this pair blocks boxes of a fan, and images may miss.
  /// @param patches_C points of patches, see BoxPatches::missable().  @param unshown_C what no patch shows.
  /// @param is_blocked whether it is the corridor that is blocked, by anything.
  void add(const std::vector<PatchPoint>& patches_C, const std::vector<Eigen::Vector3d>& unshown_C, bool is_blocked);

  /// How far each direction's box is free of what was seen before this pair, along its axis [m]; +inf: to the end.
  /// @param smallest_m edge of the smallest obstacle, as of BoxPatches.
  std::vector<double> freeUpTo(const Fan& fan_C, double smallest_m) const;

  /// From another rig: where its obstacles are now is not known.
  void takeOver(const RecentObstacles& before) { lost_s_ = blocked_s_ = before.blocked_s_; }

 private:
  struct Sighting {  // of one pair, in one fan
    double stamp_s;
    std::vector<PatchPoint> points_V;
  };

  double hold_s_ = 0.0, stamp_s_ = kNaN;
  std::optional<CameraPose> pose_;
  std::deque<Sighting> sightings_;
  // Stamps: when the corridor was blocked last, by anything, by what images may miss; and by what has lost its place.
  double blocked_s_ = -kInfinity, missable_s_ = -kInfinity, lost_s_ = -kInfinity;
};

}  // namespace flight_corridor
