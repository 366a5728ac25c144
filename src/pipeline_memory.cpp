#include <cmath>
#include <utility>
#include <vector>

#include "flight_corridor/corridor/sight.hpp"
#include "flight_corridor/pipeline.hpp"

// What the pipeline remembers of earlier pairs: matches, clear rays, obstacles, the map.

namespace flight_corridor {

namespace {

constexpr double kFastestBox_mps = 7.0;  // of a box's end: the UAV flies, and turns

}  // namespace

/// The last pair's matches become an earlier one's, before this pair overwrites them.
void Pipeline::rememberMatches() {
  if (!std::exchange(keeps_matches_, false) || !motion_.pose() || config_.corridor.memory_s <= 0.0) return;
  earlier_matches_.add(judged_s_, *motion_.pose(), disparity_);
}

/// The last pair becomes an earlier one, if its free space is trusted.
void Pipeline::remember() {
  const bool clears = std::exchange(clears_, false);
  if (!motion_.pose() || !clears || config_.corridor.memory_s <= 0.0) return;
  rays_.keepSeen();
  earlier_.add(judged_s_, *motion_.pose(), depth_m_, left_texture_.mask(), rays_.metLeft(), rays_.metRight());
}

/// A new series of poses has another frame.
void Pipeline::followMotion(const std::optional<Eigen::Isometry3d>& told_W_C) {
  const double stamp_s = report_.verdict.stamp_s;
  motion_.update(stamp_s, pair_.left, disparity_.best_px, scale(), told_W_C);
  const auto& pose = motion_.pose();
  if (pose && pose->series != series_) {
    obstacles_.clear();
    series_ = pose->series;
  }
  if (pose) known_V_C_ = pose->T_M_C, known_s_ = stamp_s;
  earlier_.moveTo(stamp_s, pose, config_.corridor.memory_s);
  earlier_matches_.moveTo(stamp_s, pose, config_.corridor.memory_s);
}

/// The frame of the camera's motion and that of the map differ by a rotation, at least: the box around the box.
void Pipeline::clearMemory(const Eigen::AlignedBox3d& box_M) {
  earlier_.forget();
  earlier_matches_.forget();
  keeps_matches_ = clears_ = false;
  if (!motion_.pose()) return obstacles_.clear();
  const Eigen::Isometry3d T_V_M = motion_.pose()->T_M_C * T_M_C_.inverse();
  Eigen::AlignedBox3d box_V;
  for (int corner = 0; corner < 8; ++corner) {
    box_V.extend(T_V_M * box_M.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
  }
  obstacles_.clear(box_V);
}

void Pipeline::updateMap() const {
  is_map_current_ = true;
  if (remembers()) {
    map_.keepAround(T_M_C_.translation(), report_.verdict.stamp_s);
  } else {
    map_.clear();
  }
  map_.insert(texturedDepth(), T_M_C_, report_.clears);
  if (const double range_m = report_.range.range_m;
      std::isfinite(report_.range_lidar_m) && range_m <= config_.map.max_range_m) {
    map_.insertBeam(T_M_C_ * range_tracker_.point(0.0), T_M_C_ * range_tracker_.point(range_m));
  }
}

const OccupancyMap& Pipeline::map() const {
  if (!is_map_current_) updateMap();
  return map_;
}

void Pipeline::updateObstacles() {
  const auto& pose = motion_.pose();
  if (!pose) return obstacles_.update(report_.verdict.stamp_s, [](const auto&) { return Sight::Nothing; });
  const Eigen::Isometry3d T_C_V = pose->T_M_C.inverse();
  obstacles_.update(report_.verdict.stamp_s, [&](const Eigen::Vector3d& centre_V) {
    return clears_ ? sightOf(evidence(), geometry_, T_C_V * centre_V, config_.map.resolution_m) : Sight::Nothing;
  });
  if (image_faults_ != 0 || config_.corridor.memory_s <= 0.0) return;
  std::vector<Eigen::Vector3d> points_V;
  for (const Eigen::Vector3d& p_C : inspector_.blocking()) points_V.push_back(pose->T_M_C * p_C);
  obstacles_.add(points_V, report_.verdict.stamp_s);
}

/// What is remembered of a box: obstacles that the newest pair does not show, and what the map in a fixed frame knows.
/// @return places in C.
OccupiedCell Pipeline::remembered(const Box& box_C) const {
  OccupiedCell remembered;
  if (remembers()) remembered = nearestOccupied(map_.tree(), {T_M_C_ * box_C.T_M_F, box_C.size_m});
  remembered.centre = T_M_C_.inverse() * remembered.centre;
  if (!motion_.pose()) return remembered;
  const Eigen::Isometry3d &T_V_C = motion_.pose()->T_M_C, T_C_V = T_V_C.inverse();
  const auto counts = [&](const Eigen::Vector3d& centre_V) {
    const bool is_earlier = obstacles_.seen(centre_V) < report_.verdict.stamp_s;
    return is_earlier && sightOf(evidence(), geometry_, T_C_V * centre_V, config_.map.resolution_m) == Sight::Nothing;
  };
  const OccupiedCell obstacle = nearestOccupied(obstacles_.tree(), {T_V_C * box_C.T_M_F, box_C.size_m}, counts);
  if (obstacle.clear_distance_m >= remembered.clear_distance_m) return remembered;
  return {obstacle.clear_distance_m, T_C_V * obstacle.centre};
}

/// Whether a remembered obstacle may be in a box while nobody knows where the camera is: one that was no farther from
/// it, at the last known pose, than the camera and the box may have moved since.
bool Pipeline::mayHoldLostObstacle(const Box& box_C) const {
  if (motion_.pose() || obstacles_.tree().size() == 0) return false;
  const double moved_m = kFastestBox_mps * (report_.verdict.stamp_s - known_s_);
  if (!(moved_m <= config_.map.max_range_m)) return true;
  const Eigen::Isometry3d T_V_F = known_V_C_ * box_C.T_M_F * Eigen::Translation3d(-moved_m, 0.0, 0.0);
  return nearestOccupied(obstacles_.tree(), {T_V_F, box_C.size_m.array() + 2.0 * moved_m}).clear_distance_m < kInfinity;
}

}  // namespace flight_corridor
