#pragma once

#include <vector>

#include "flight_corridor/corridor/box_patches.hpp"
#include "flight_corridor/corridor/verdict.hpp"

namespace flight_corridor {

/// What blocked a box lately, and whether it may be there still though the newest image does not show it. Images that
/// follow each other miss thin and small obstacles now and then, and move what stands at the box's edge in and out.
class RecentBlock {
 public:
  /// @param hold_s for so long FREE waits for what may be missed.
  explicit RecentBlock(double hold_s) : hold_s_(hold_s) {}

  /// From now on FREE waits for so long.
  void setHold(double hold_s) { hold_s_ = hold_s; }

  /// Something blocks the box. It cannot be missed if the newest pair shows it, and shows it large.
  /// @param verdict with its stamp and clear distance.  @param patches of the newest pair.
  void onBlocked(const Verdict& verdict, const std::vector<BoxPatch>& patches, double smallest_m);

  /// Within hold_s: after what may be missed, and after what stood at the box's edge while something still does.
  bool mayRemain(double stamp_s, const std::vector<BoxPatch>& patches, double smallest_m) const;

  /// Of another rig's images: all that blocked may be missed by the new one.
  void takeOver(const RecentBlock& before) { blocked_s_ = missable_s_ = before.blocked_s_; }

 private:
  double hold_s_;
  // Stamps of the last BLOCKED: by anything, by what may be missed, by what reached no farther than the box's edge.
  double blocked_s_ = -kInfinity, missable_s_ = -kInfinity, edge_s_ = -kInfinity;
};

}  // namespace flight_corridor
