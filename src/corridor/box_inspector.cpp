#include "flight_corridor/corridor/box_inspector.hpp"

#include "flight_corridor/corridor/railing.hpp"

namespace flight_corridor {

BoxInspector::BoxInspector(const StereoGeometry& geometry)
    : geometry_(geometry), view_(geometry), patches_(geometry), holes_(geometry), doubt_(geometry) {}

const BoxEvidence& BoxInspector::inspect(const Box& box_C, const PairEvidence& pair, double from_m, double smallest_m,
                                         bool is_lidar_valid, BandWorkers& workers) {
  view_.look(box_C, from_m);
  workers.run(2, [&](int part, int) {
    if (part == 0) {
      evidence_.is_ambiguous =
          doubt_.isIn(view_, pair.disparity, pair.correction, is_lidar_valid, smallest_m) ||
          mayBeRailing(box_C, pair.images, pair.depth_m, pair.nearest_m, is_lidar_valid, geometry_);
    } else {
      evidence_.patches = patches_.find(box_C, pair.depth_m, pair.textured, pair.nearest_m, smallest_m);
      evidence_.unobserved = holes_.find(box_C, view_, pair.rays, pair.correction, from_m, pair.nearest_m, smallest_m);
    }
  });
  return evidence_;
}

}  // namespace flight_corridor
