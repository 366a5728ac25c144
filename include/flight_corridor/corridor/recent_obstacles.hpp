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
  /// @param is_corridor whether the fan is the corridor: while the place of its obstacles is not known, nothing is
  /// free.
  void add(const std::vector<PatchPoint>& patches_C, const std::vector<Eigen::Vector3d>& unshown_C, bool is_corridor);

  /// The corridor is blocked at this pair, by anything.
  void onBlocked() { blocked_s_ = stamp_s_; }

  /// How far each direction's box is free of what was seen before this pair, along its axis [m]; +inf: to the end.
  /// @param smallest_m edge of the smallest obstacle, as of BoxPatches.
  std::vector<double> freeUpTo(const Fan& fan_C, double smallest_m) const;

  /// From another rig: where the corridor's obstacles are now is not known.
  void takeOver(const RecentObstacles& before);

 private:
  struct Sighting {  // of one pair, in one fan
    int pair;
    double stamp_s;
    std::optional<CameraPose> pose;
    std::vector<PatchPoint> points_C;
    bool is_corridor;
  };

  double stamp_s_ = kNaN, blocked_s_ = -kInfinity;
  int pair_ = 0;
  std::optional<CameraPose> pose_;
  std::deque<Sighting> sightings_;
};

}  // namespace flight_corridor
