#include "flight_corridor/corridor/box_inspector.hpp"

#include <algorithm>

namespace flight_corridor {

BoxInspector::BoxInspector(const StereoGeometry& geometry)
    : geometry_(geometry), patches_(geometry), holes_(geometry), doubt_(geometry), railings_(geometry), evidence_(1) {}

const std::vector<BoxEvidence>& BoxInspector::inspect(const Fan& fan, const PairEvidence& pair,
                                                      const CorridorConfig& config, const std::vector<double>& lidar_px,
                                                      BandWorkers& workers) {
  const bool is_one = fan.size() == 1;
  const double smallest_m = smallestInspected(config);
  const double nearest_m = geometry_.depth(pair.correction.correct(geometry_.disparity(pair.nearest_m)));
  evidence_.resize(fan.size());
  const auto find_patches = [&] {
    const double beside_m = is_one ? BoxPatches::kBeside_m : 0.0;
    const auto& patches = patches_.find(fan, pair.depth_m, pair.textured, nearest_m, smallest_m, beside_m);
    for (int i = 0; i < fan.size(); ++i) evidence_[i].patches = patches[i];
  };
  const auto find_holes = [&] {
    const auto& holes = holes_.find(fan, absenceOf(pair), pair.correction, config.blind_m, nearest_m, smallest_m,
                                    config.max_unknown_fraction);
    const std::vector<double> gaps_m = pair.gaps.freeUpTo(fan, smallest_m);
    for (int i = 0; i < fan.size(); ++i) {
      evidence_[i].unobserved = holes[i];
      evidence_[i].unobserved.hole_along_m = std::min(holes[i].hole_along_m, gaps_m[i]);
    }
  };
  const auto look_for_railings = [&] {
    railings_.look(fan, pair.images, pair.depth_m, pair.nearest_m);
    if (is_one) evidence_[0].is_ambiguous = railings_.mayBeIn(fan.box(0), lidar_px[0]);
  };
  workers.run(3, [&](int part, int) { part == 0 ? find_holes() : part == 1 ? find_patches() : look_for_railings(); });
  questions_.clear();
  for (int i = 0; i < fan.size(); ++i) {  // of many, one with a near hole is of no use unless a patch blocks it
    BoxEvidence& evidence = evidence_[i];
    const auto blocks = [&](const BoxPatch& patch) { return patch.blocks(smallest_m * smallest_m); };
    const bool is_open = is_one || evidence.unobserved.hole_along_m > config.width_m ||
                         std::any_of(evidence.patches.begin(), evidence.patches.end(), blocks);
    evidence.is_doubt_searched = is_open;
    if (!is_one) evidence.is_ambiguous = is_open && railings_.mayBeIn(fan.box(i), lidar_px[i]);
    questions_.push_back({is_open, lidar_px[i]});
  }
  doubt_.find(fan, config.blind_m, pair.disparity, pair.earlier_matches, pair.correction, questions_, smallest_m,
              workers);
  for (int i = 0; i < fan.size(); ++i) evidence_[i].is_ambiguous |= doubt_.isIn(i);
  return evidence_;
}

}  // namespace flight_corridor
