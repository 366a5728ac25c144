#include "flight_corridor/corridor/corridor.hpp"

#include <algorithm>

namespace flight_corridor {

namespace {

constexpr double kSmallest_m = 0.01;  // edge: of smaller ones a pixel is one

}  // namespace

double smallestInspected(const CorridorConfig& config) { return std::max(config.smallest_obstacle_m, kSmallest_m); }

Box corridorBox(const CorridorConfig& config, const Eigen::Isometry3d& T_M_F) {
  Box box;
  box.T_M_F = T_M_F * Eigen::Translation3d(config.offset_m);
  const double margin = config.margin_m;
  box.size_m = {config.length_m + margin, config.width_m + 2.0 * margin, config.height_m + 2.0 * margin};
  return box;
}

}  // namespace flight_corridor
