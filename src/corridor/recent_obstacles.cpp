#include "flight_corridor/corridor/recent_obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace flight_corridor {

void RecentObstacles::moveTo(double stamp_s, const std::optional<CameraPose>& pose, double hold_s) {
  if (!pose || !pose_ || pose->series != pose_->series) {
    sightings_.clear();
    lost_s_ = std::max(lost_s_, missable_s_);
  }
  stamp_s_ = stamp_s, pose_ = pose, hold_s_ = hold_s;
  while (!sightings_.empty() && !(stamp_s - sightings_.front().stamp_s <= hold_s)) sightings_.pop_front();
}

void RecentObstacles::add(const std::vector<PatchPoint>& patches_C, const std::vector<Eigen::Vector3d>& unshown_C,
                          bool is_blocked) {
  const bool is_missable = !patches_C.empty() || !unshown_C.empty();
  if (is_blocked) blocked_s_ = stamp_s_;
  if (is_blocked && is_missable) missable_s_ = stamp_s_;
  if (!is_missable || !pose_) return;
  const Eigen::Isometry3f T_V_C = pose_->T_M_C.cast<float>();
  Sighting sighting{stamp_s_, patches_C};
  for (const Eigen::Vector3d& p_C : unshown_C) {
    sighting.points_V.push_back({p_C.cast<float>(), std::numeric_limits<float>::infinity()});
  }
  for (PatchPoint& point : sighting.points_V) point.at = T_V_C * point.at;
  sightings_.push_back(std::move(sighting));
}

std::vector<double> RecentObstacles::freeUpTo(const Fan& fan_C, double smallest_m) const {
  const bool is_lost = std::abs(stamp_s_ - lost_s_) <= hold_s_;  // it may be anywhere
  std::vector<double> free_m(fan_C.size(), is_lost ? 0.0 : kInfinity);
  if (!pose_) return free_m;
  const Eigen::Isometry3f T_F_V = fan_C.T_F_C() * pose_->T_M_C.inverse().cast<float>();
  for (const Sighting& sighting : sightings_) {
    if (sighting.stamp_s < stamp_s_) limit(fan_C, T_F_V, sighting.points_V, smallest_m, free_m);
  }
  return free_m;
}

}  // namespace flight_corridor
