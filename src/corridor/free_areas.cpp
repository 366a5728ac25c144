#include "flight_corridor/corridor/free_areas.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr double kScanned_rad = 0.7;  // to the left and to the right: about the view of a camera

}  // namespace

std::vector<double> gridAngles(double limit_rad, double step_rad) {
  const int steps = static_cast<int>(limit_rad / step_rad + 0.01);  // a limit of whole steps is one, as rounded
  std::vector<double> angles_rad;
  for (int i = -steps; i <= steps; ++i) angles_rad.push_back(i * step_rad);
  return angles_rad;
}

LevelScan unknownScan(double step_rad, double max_range_m) {
  const std::vector<double> yaws_rad = gridAngles(kScanned_rad, step_rad);
  return {yaws_rad.front(), step_rad, max_range_m, std::vector<double>(yaws_rad.size(), kNaN)};
}

AreaGrid areaGrid(const FreeAreasConfig& config) {
  const std::vector<double> yaws_rad = gridAngles(config.yaw_rad, config.step_rad);
  const std::vector<double> pitches_rad = gridAngles(config.pitch_rad, config.step_rad);
  AreaGrid grid;
  grid.columns = static_cast<int>(yaws_rad.size());
  grid.rows = static_cast<int>(pitches_rad.size());
  for (const double pitch_rad : pitches_rad) {
    for (const double yaw_rad : yaws_rad) grid.areas.push_back({yaw_rad, pitch_rad, {}});
  }
  return grid;
}

Eigen::Vector3d ahead(const FreeArea& area) {
  return {std::cos(area.yaw_rad) * std::cos(area.pitch_rad), std::sin(area.yaw_rad) * std::cos(area.pitch_rad),
          std::sin(area.pitch_rad)};
}

int bestArea(const AreaGrid& grid, const Eigen::Vector3d& goal_F, double step_rad) {
  const auto is_free = [&](int row, int column) {
    return 0 <= row && row < grid.rows && 0 <= column && column < grid.columns &&
           grid.areas[row * grid.columns + column].verdict.state == State::Free;
  };
  const bool is_goal = goal_F.allFinite() && goal_F.stableNorm() > 0.0;
  const Eigen::Vector3d goal = is_goal ? goal_F.stableNormalized() : Eigen::Vector3d::UnitX();
  int best = -1, best_beside = 0;
  long best_steps = 0;
  double best_rad = kInfinity;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (!is_free(row, column)) continue;
      const int at = row * grid.columns + column;
      const double away_rad = std::acos(std::clamp(goal.dot(ahead(grid.areas[at])), -1.0, 1.0));
      const long steps = std::lround(away_rad / step_rad);
      int beside = 0;
      for (const int up : {-1, 0, 1}) {
        for (const int left : {-1, 0, 1}) beside += is_free(row + up, column + left);
      }
      const bool is_better =
          best < 0 || steps < best_steps ||
          (steps == best_steps && (beside > best_beside || (beside == best_beside && away_rad < best_rad)));
      if (!is_better) continue;
      best = at, best_steps = steps, best_beside = beside, best_rad = away_rad;
    }
  }
  return best;
}

}  // namespace flight_corridor
