#pragma once

#include "flight_corridor/box.hpp"
#include "flight_corridor/occupancy_map.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// What blocked a box lately, and whether it may be there still though the newest image does not show it. Images that
/// follow each other miss thin and small things now and then, broad ones never; and they move what stands at the box's
/// edge in and out.
class RecentBlock {
 public:
  /// @param hold_s for so long FREE waits for what may be missed.
  RecentBlock(double hold_s, double cell_m) : hold_s_(hold_s), cell_m_(cell_m) {}

  /// Something blocks the box. It cannot be missed if the newest image shows it and every cell that is hit in the box
  /// is solid, in a large group of cells that touch each other and not thin, or at the edge of one that is.
  /// @param verdict with its stamp and clear distance.
  /// @param newest map of the newest image, in C.
  /// @param box in C.
  void note(const Verdict& verdict, const OccupancyMap& newest, const Box& box);

  /// Within hold_s after something that may be missed, and after something at the box's edge while a cell there is hit.
  bool mayRemain(double stamp_s, const OccupancyMap& newest, const Box& box) const;

  /// Of another rig's images: all that blocked may be missed by the new one.
  void takeOver(const RecentBlock& before) { missable_s_ = before.blocked_s_; }

 private:
  bool isMissable(double clear_distance_m, const OccupancyMap& newest, const Box& box) const;
  bool isAtEdge(const OccupancyMap& newest, Box box) const;
  bool isLarge(std::size_t cells) const;
  double atEdge() const;

  double hold_s_, cell_m_;
  // Stamps of the last BLOCKED: by anything, by what may be missed, by what reached no farther than the box's edge.
  double blocked_s_ = -kInfinity, missable_s_ = -kInfinity, edge_s_ = -kInfinity;
};

}  // namespace flight_corridor
