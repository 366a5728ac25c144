#pragma once

#include <memory_resource>
#include <optional>

#include "flight_corridor/corridor/verdict.hpp"
#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/map/occupancy_map.hpp"

namespace flight_corridor {

/// What blocked a box lately, and whether it may be there still though the newest image does not show it. Images that
/// follow each other miss thin and small obstacles now and then, and move what stands at the box's edge in and out.
class RecentBlock {
 public:
  /// @param hold_s for so long FREE waits for what may be missed.
  RecentBlock(double hold_s, double cell_m) : hold_s_(hold_s), cell_m_(cell_m) {}

  /// From now on FREE waits for so long.
  void setHold(double hold_s) { hold_s_ = hold_s; }

  /// Something blocks the box. It cannot be missed if the newest image shows it and every cell that is hit in the box
  /// belongs to something large: to a group of cells that touch each other, to what touches these, or to what lies
  /// behind their outline.
  /// @param verdict with its stamp and clear distance.
  /// @param beam_end_m along the box's axis, where the beam ends in the box.
  /// @param newest map of the newest image, in C.
  /// @param box in C.
  /// @param memory for scratch.
  void note(const Verdict& verdict, const std::optional<double>& beam_end_m, const OccupancyMap& newest, const Box& box,
            std::pmr::memory_resource* memory = std::pmr::get_default_resource());

  /// Within hold_s: after what may be missed, after what stood at the box's edge while a cell near the box is hit, and
  /// while one that touches it is.
  bool mayRemain(double stamp_s, const OccupancyMap& newest, const Box& box) const;

  /// Of another rig's images: all that blocked may be missed by the new one.
  void takeOver(const RecentBlock& before) { blocked_s_ = missable_s_ = before.blocked_s_; }

 private:
  double reach() const;

  double hold_s_, cell_m_;
  // Stamps of the last BLOCKED: by anything, by what may be missed, by what reached no farther than the box's edge.
  double blocked_s_ = -kInfinity, missable_s_ = -kInfinity, edge_s_ = -kInfinity;
};

}  // namespace flight_corridor
