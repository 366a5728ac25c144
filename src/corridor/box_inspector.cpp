#include "flight_corridor/corridor/box_inspector.hpp"

#include <algorithm>

namespace flight_corridor {

BoxInspector::BoxInspector(const StereoGeometry& geometry)
    : patches_(geometry), holes_(geometry), doubt_(geometry), railings_(geometry), evidence_(1) {}

const std::vector<BoxEvidence>& BoxInspector::inspect(const Fan& fan, const PairEvidence& pair, double from_m,
                                                      double smallest_m, const std::vector<bool>& is_lidar_valid,
                                                      BandWorkers& workers) {
  const bool is_one = fan.size() == 1;
  evidence_.resize(fan.size());
  workers.run(2, [&](int part, int) {
    if (part == 0) {
      const double beside_m = is_one ? BoxPatches::kBeside_m : 0.0;
      const auto& patches = patches_.find(fan, pair.depth_m, pair.textured, pair.nearest_m, smallest_m, beside_m);
      for (int i = 0; i < fan.size(); ++i) evidence_[i].patches = patches[i];
    } else {
      const auto& holes = holes_.find(fan, pair.rays, pair.correction, from_m, pair.nearest_m, smallest_m);
      for (int i = 0; i < fan.size(); ++i) evidence_[i].unobserved = holes[i];
    }
  });
  questions_.clear();
  for (int i = 0; i < fan.size(); ++i) {
    const auto& patches = evidence_[i].patches;
    const bool is_blocked = std::any_of(patches.begin(), patches.end(),
                                        [&](const BoxPatch& patch) { return patch.blocks(smallest_m * smallest_m); });
    const bool is_unknown = !is_blocked && evidence_[i].unobserved.hasHole();
    questions_.push_back({is_one || !is_unknown, is_lidar_valid[i]});
  }
  workers.run(2, [&](int part, int) {
    if (part == 0) {
      doubt_.find(fan, from_m, pair.disparity, pair.correction, questions_, smallest_m);
    } else {
      railings_.look(fan, pair.images, pair.depth_m, pair.nearest_m);
      for (int i = 0; i < fan.size(); ++i) {
        evidence_[i].is_ambiguous = questions_[i].is_open && railings_.mayBeIn(fan.box(i), is_lidar_valid[i]);
      }
    }
  });
  for (int i = 0; i < fan.size(); ++i) evidence_[i].is_ambiguous |= doubt_.isIn(i);
  return evidence_;
}

}  // namespace flight_corridor
