#include "flight_corridor/thin_things.hpp"

#include <algorithm>
#include <cstdint>

namespace flight_corridor {

namespace {

constexpr double kError_px = 0.6, kLevelError_px = 1.0;  // of a match, at the most; of a level edge's
constexpr double kFewest_px = 12.0;                      // fewer are chance
// Of a leaf of a few pixels, that its surroundings blur:
constexpr double kLeafError_px = 0.4, kFewestOfLeaf_px = 25.0, kFewestThinOfLeaf_px = 8.0;

/// Matches, each counted by the share of a pixel that what it shows would take at the box's end, up to 1.
struct Matches {
  double thin_behind = 0.0;  // of thin things that may be in the box and are taken to be behind it
  double thin = 0.0;         // of all thin things that may be in the box
  double any = 0.0;          // of all things
};

}  // namespace

bool mayHoldThinThing(const Box& box_C, const cv::Mat& depth_m, const Disparity& disparity,
                      const StereoGeometry& geometry, double band_px) {
  const double end_m = farthestCorner(box_C), farthest_m = geometry.shiftedDepth(end_m, -kLevelError_px);
  const Eigen::Isometry3d T_F_C = box_C.T_M_F.inverse();
  Matches matches;
  for (int v = 0; v < disparity.thin.rows; ++v) {
    const auto* is_thin = disparity.thin.ptr<std::uint8_t>(v);
    const auto* is_level = disparity.level.ptr<std::uint8_t>(v);
    const auto* z_m = depth_m.ptr<float>(v);
    for (int u = 0; u < disparity.thin.cols; ++u) {
      if (!(0.0f < z_m[u] && z_m[u] <= farthest_m)) continue;
      const double weight = std::min(z_m[u] * z_m[u] / (end_m * end_m), 1.0);
      const auto inBox = [&](double nearer_px) {
        const Eigen::Vector3d point_F = T_F_C * geometry.point(u, v, geometry.shiftedDepth(z_m[u], nearer_px));
        return contains(box_C.size_m, point_F) ? weight : 0.0;
      };
      matches.any += inBox(kLeafError_px);
      if (!is_thin[u]) continue;
      matches.thin += inBox(kLevelError_px);
      if (inBox(band_px) == 0.0) matches.thin_behind += inBox(is_level[u] ? kLevelError_px : kError_px);
    }
  }
  return matches.thin_behind >= kFewest_px || (matches.any >= kFewestOfLeaf_px && matches.thin >= kFewestThinOfLeaf_px);
}

}  // namespace flight_corridor
