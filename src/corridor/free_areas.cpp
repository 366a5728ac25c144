#include "flight_corridor/corridor/free_areas.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

int stepsTo(double limit_rad, double step_rad) { return static_cast<int>(limit_rad / step_rad + 0.01); }

}  // namespace

Violations check(const FreeAreasConfig& config) {
  Rules rules("free_areas");
  rules.require(0.0 <= config.yaw_rad && config.yaw_rad <= 1.2, "yaw_rad", "0 to 1.2", config.yaw_rad);
  rules.require(0.0 <= config.pitch_rad && config.pitch_rad <= 0.8, "pitch_rad", "0 to 0.8", config.pitch_rad);
  rules.require(0.02 <= config.step_rad && config.step_rad <= 1.0, "step_rad", "0.02 to 1", config.step_rad);
  return rules.broken();
}

FreeAreas directions(const FreeAreasConfig& config) {
  const int columns = stepsTo(config.yaw_rad, config.step_rad), rows = stepsTo(config.pitch_rad, config.step_rad);
  FreeAreas grid;
  grid.columns = 2 * columns + 1;
  grid.rows = 2 * rows + 1;
  for (int row = -rows; row <= rows; ++row) {
    for (int column = -columns; column <= columns; ++column) {
      grid.areas.push_back({column * config.step_rad, row * config.step_rad, {}});
    }
  }
  return grid;
}

Eigen::Matrix3d turnTo(const FreeArea& area) {
  return (Eigen::AngleAxisd(area.yaw_rad, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(-area.pitch_rad, Eigen::Vector3d::UnitY()))
      .toRotationMatrix();
}

int bestArea(const FreeAreas& grid, const Eigen::Vector3d& goal_F, double step_rad) {
  const auto is_free = [&](int row, int column) {
    return 0 <= row && row < grid.rows && 0 <= column && column < grid.columns &&
           grid.areas[row * grid.columns + column].verdict.state == State::Free;
  };
  const Eigen::Vector3d goal = goal_F.normalized();
  int best = -1, best_beside = 0;
  long best_steps = 0;
  double best_rad = kInfinity;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (!is_free(row, column)) continue;
      const int at = row * grid.columns + column;
      const double away_rad = std::acos(std::clamp(goal.dot(turnTo(grid.areas[at]).col(0)), -1.0, 1.0));
      const long steps = std::lround(away_rad / step_rad);
      int beside = 0;
      for (const int up : {-1, 0, 1}) {
        for (const int left : {-1, 0, 1}) beside += is_free(row + up, column + left);
      }
      const bool is_better = best < 0 || steps < best_steps ||
                             (steps == best_steps && (beside > best_beside || (beside == best_beside && away_rad < best_rad)));
      if (!is_better) continue;
      best = at, best_steps = steps, best_beside = beside, best_rad = away_rad;
    }
  }
  return best;
}

}  // namespace flight_corridor
