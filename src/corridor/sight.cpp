#include "flight_corridor/corridor/sight.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr int kSamples = 6;          // along the cube's edge
constexpr double kClearShare = 0.9;  // of the samples: what is thinner than the rest may stand in the cube

}  // namespace

Sight sightOf(const PairEvidence& pair, const StereoGeometry& geometry, const Eigen::Vector3d& centre_C,
              double edge_m) {
  const double near_m = centre_C.z() - 0.5 * edge_m, far_m = centre_C.z() + 0.5 * edge_m;
  if (!(near_m >= pair.nearest_m)) return Sight::Nothing;
  const auto far_px = static_cast<float>(geometry.disparity(far_m));
  const int shift_px =
      static_cast<int>(std::lround(far_px * pair.correction.scale(far_px) + geometry.principalPointDifference()));
  int clear = 0;
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      const Eigen::Vector3d off_m =
          edge_m * Eigen::Vector3d((i + 0.5) / kSamples - 0.5, (j + 0.5) / kSamples - 0.5, 0.0);
      const Eigen::Vector2d at_px = geometry.project(centre_C + off_m);
      if (!geometry.contains(at_px) || at_px.x() < shift_px) return Sight::Nothing;
      clear += pair.rays.isClear(static_cast<int>(std::lround(at_px.x())), static_cast<int>(std::lround(at_px.y())),
                                 far_px, shift_px);
    }
  }
  return clear >= kClearShare * kSamples * kSamples ? Sight::Clear : Sight::Unclear;
}

}  // namespace flight_corridor
