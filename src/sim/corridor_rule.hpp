#pragma once

#include "flight_corridor/pipeline.hpp"
#include "sim/closed_loop.hpp"

namespace flight_corridor::sim {

/// This package's rule: the free areas about a level frame along the heading.
class CorridorRule {
 public:
  /// @throws std::invalid_argument as Pipeline does.
  CorridorRule(const Config& config, const ClosedLoop& loop);

  Way judge(const Observation& observation);

  Pipeline& pipeline() { return pipeline_; }
  /// Of the last pair.
  const AreaGrid& areas() const { return *areas_; }
  /// T_W_F of the frame that the areas' directions are of: level, at the camera.
  const Eigen::Isometry3d& T_W_F() const { return T_W_F_; }

 private:
  double freeAlong(const Eigen::Vector3d& direction_W) const;

  Eigen::Isometry3d T_B_C_;
  Pipeline pipeline_;
  const AreaGrid* areas_ = nullptr;
  Eigen::Isometry3d T_W_F_ = Eigen::Isometry3d::Identity();
};

/// How far the UAV may fly along a direction and still turn on the spot: where it is not FREE, a box's width less [m].
double usableDistance(const Verdict& verdict, double width_m);

/// The best direction of a grid, unless along another, usable for a shorter way, the UAV gets nearer to the goal
/// faster.
/// @param goal_F unit vector to the goal in the corridor's frame.  @param width_m of the corridor.  @param speed how
/// the UAV brakes.
/// @return its index; -1: none is usable.
int bestWay(const AreaGrid& areas, const Eigen::Vector3d& goal_F, double width_m, const SpeedConfig& speed);

/// T_W_F at the camera's place: z up, x along the body's heading.
Eigen::Isometry3d levelFrame(const Eigen::Isometry3d& T_W_B, const Eigen::Isometry3d& T_B_C);

}  // namespace flight_corridor::sim
