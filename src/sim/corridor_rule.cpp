#include "sim/corridor_rule.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor::sim {
namespace {

const Eigen::Vector3d kGravity_W_mps2(0.0, 0.0, -9.80665);

}  // namespace

Eigen::Isometry3d levelFrame(const Eigen::Isometry3d& T_W_B, const Eigen::Isometry3d& T_B_C) {
  Eigen::Isometry3d T_W_F = Eigen::Isometry3d::Identity();
  T_W_F.translation() = T_W_B * T_B_C.translation();
  T_W_F.rotate(Eigen::AngleAxisd(std::atan2(T_W_B(1, 0), T_W_B(0, 0)), Eigen::Vector3d::UnitZ()));
  return T_W_F;
}

double usableDistance(const Verdict& verdict, double width_m) {
  return verdict.state == State::Free ? verdict.free_distance_m : std::max(0.0, verdict.free_distance_m - width_m);
}

int bestWay(const AreaGrid& areas, const Eigen::Vector3d& goal_F, double width_m, const SpeedConfig& speed) {
  const auto nearing_mps = [&](const FreeArea& area) {
    return safeSpeed(usableDistance(area.verdict, width_m), 0.0, speed) * goal_F.dot(ahead(area));
  };
  int best = areas.best;
  double best_mps = best < 0 ? 0.0 : std::max(0.0, nearing_mps(areas.areas[static_cast<std::size_t>(best)]));
  for (std::size_t i = 0; i < areas.areas.size(); ++i) {
    const double mps = nearing_mps(areas.areas[i]);
    if (areas.areas[i].verdict.state == State::Free || mps <= best_mps) continue;
    best = static_cast<int>(i);
    best_mps = mps;
  }
  return best;
}

CorridorRule::CorridorRule(const Config& config, const ClosedLoop& loop)
    : T_B_C_(loop.T_B_C()),
      pipeline_(config, StereoGeometry(loop.calibration()), {loop.T_C_L(), opticalFromForward()}) {}

Way CorridorRule::judge(const Observation& observation) {
  const Eigen::Isometry3d& T_W_B = observation.own.T_W_B;
  const Eigen::Isometry3d T_W_C = T_W_B * T_B_C_;
  for (const RangeReading& reading : observation.ranges) pipeline_.addRange(reading);
  for (const ImuReading& imu : observation.imu) {
    const Eigen::Vector3d acceleration_B = imu.specific_force_B_mps2 + imu.R_W_B.conjugate() * kGravity_W_mps2;
    pipeline_.addAcceleration(imu.stamp_s, T_B_C_.linear().transpose() * acceleration_B);
  }
  T_W_F_ = levelFrame(T_W_B, T_B_C_);
  pipeline_.pointAlong(T_W_C.inverse() * T_W_F_);
  pipeline_.process(observation.pair, T_W_C);
  const Eigen::Vector3d goal_W = observation.goal_W - T_W_C.translation();
  areas_ = &pipeline_.freeAreas(T_W_C.linear().transpose() * goal_W);
  const Config& config = pipeline_.config();
  const Eigen::Vector3d goal_F = (T_W_F_.linear().transpose() * goal_W).normalized();
  Way way;
  if (const int best = bestWay(*areas_, goal_F, config.corridor.width_m, config.speed); best >= 0) {
    const FreeArea& area = areas_->areas[static_cast<std::size_t>(best)];
    way.direction_W = T_W_F_.linear() * ahead(area);
    way.free_m = usableDistance(area.verdict, config.corridor.width_m);
  }
  way.free_ahead_m = freeAlong(observation.own.velocity_W_mps);
  return way;
}

/// Of the nearest direction of the grid; 0 beside it.
double CorridorRule::freeAlong(const Eigen::Vector3d& direction_W) const {
  if (direction_W.isZero()) return 0.0;
  const Eigen::Vector3d direction_F = (T_W_F_.linear().transpose() * direction_W).normalized();
  double nearest_rad = pipeline_.config().free_areas.step_rad, free_m = 0.0;
  for (const FreeArea& area : areas_->areas) {
    const double away_rad = std::acos(std::clamp(direction_F.dot(ahead(area)), -1.0, 1.0));
    if (away_rad >= nearest_rad) continue;
    nearest_rad = away_rad;
    free_m = area.verdict.free_distance_m;
  }
  return free_m;
}

}  // namespace flight_corridor::sim
