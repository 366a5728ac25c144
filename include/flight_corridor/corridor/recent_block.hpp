#pragma once

#include <vector>

#include "flight_corridor/corridor/box_patches.hpp"
#include "flight_corridor/corridor/verdict.hpp"

namespace flight_corridor {

/// The last obstacle in a box, and whether it may still be there although the newest image does not show it. Single
/// images miss thin and small obstacles now and then, and noise moves obstacles at the box's edge in and out.
class RecentBlock {
 public:
  /// @param hold_s FREE waits for this long after an obstacle that images may miss.
  explicit RecentBlock(double hold_s) : hold_s_(hold_s) {}

  /// Sets the wait from now on.
  void setHold(double hold_s) { hold_s_ = hold_s; }

  /// An obstacle blocks the box. Images cannot miss it if the newest pair shows it, and shows it large.
  /// @param verdict with its stamp and clear distance.  @param patches of the newest pair.
  void onBlocked(const Verdict& verdict, const std::vector<BoxPatch>& patches, double smallest_m);

  /// Whether an obstacle may remain, within hold_s: one that images may miss, or one at the box's edge while there
  /// still is one.
  bool mayRemain(double stamp_s, const std::vector<BoxPatch>& patches, double smallest_m) const;

  /// From another rig: the new one's images may miss any obstacle of before.
  void takeOver(const RecentBlock& before) { blocked_s_ = missable_s_ = before.blocked_s_; }

 private:
  double hold_s_;
  // Stamps of the last BLOCKED: by any obstacle, by one that images may miss, by one at the box's edge only.
  double blocked_s_ = -kInfinity, missable_s_ = -kInfinity, edge_s_ = -kInfinity;
};

}  // namespace flight_corridor
