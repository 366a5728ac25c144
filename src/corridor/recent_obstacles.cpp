#include "flight_corridor/corridor/recent_obstacles.hpp"

#include <limits>
#include <utility>

namespace flight_corridor {

void RecentObstacles::moveTo(double stamp_s, const std::optional<CameraPose>& pose, double hold_s) {
  ++pair_;
  stamp_s_ = stamp_s, pose_ = pose;
  while (!sightings_.empty() && !(stamp_s - sightings_.front().stamp_s <= hold_s)) sightings_.pop_front();
}

void RecentObstacles::add(const std::vector<PatchPoint>& patches_C, const std::vector<Eigen::Vector3d>& unshown_C,
                          bool is_corridor) {
  if (patches_C.empty() && unshown_C.empty()) return;
  Sighting sighting{pair_, stamp_s_, pose_, patches_C, is_corridor};
  for (const Eigen::Vector3d& p_C : unshown_C) {
    sighting.points_C.push_back({p_C.cast<float>(), std::numeric_limits<float>::infinity()});
  }
  sightings_.push_back(std::move(sighting));
}

std::vector<double> RecentObstacles::freeUpTo(const Fan& fan_C, double smallest_m) const {
  std::vector<double> free_m(fan_C.size(), kInfinity);
  for (const Sighting& sighting : sightings_) {
    if (sighting.pair == pair_) continue;
    if (pose_ && sighting.pose && motionBetween(*sighting.pose, *pose_)) {
      const Eigen::Isometry3d T_C_E = pose_->T_M_C.inverse() * sighting.pose->T_M_C;
      shorten(fan_C, fan_C.T_F_C() * T_C_E.cast<float>(), sighting.points_C, smallest_m, free_m);
    } else if (sighting.is_corridor) {
      free_m.assign(fan_C.size(), 0.0);
    }
  }
  return free_m;
}

void RecentObstacles::takeOver(const RecentObstacles& before) {
  blocked_s_ = before.blocked_s_;
  sightings_.assign(1, {pair_, blocked_s_, std::nullopt, {}, true});
}

}  // namespace flight_corridor
