#include "flight_corridor/thin_things.hpp"

#include <cstdint>

namespace flight_corridor {

namespace {

constexpr double kError_px = 0.6, kLevelError_px = 1.0;  // of a match, at the most; of a level edge's
constexpr int kFewest_px = 12;                           // fewer are chance

}  // namespace

bool mayHoldThinThing(const Box& box_C, const cv::Mat& depth_m, const Disparity& disparity,
                      const StereoGeometry& geometry, double band_px) {
  int points = 0;
  for (int v = 0; v < disparity.thin.rows; ++v) {
    const auto* is_thin = disparity.thin.ptr<std::uint8_t>(v);
    const auto* is_level = disparity.level.ptr<std::uint8_t>(v);
    const auto* z_m = depth_m.ptr<float>(v);
    for (int u = 0; u < disparity.thin.cols; ++u) {
      if (!is_thin[u] || !(z_m[u] > 0.0f)) continue;
      const auto isInBox = [&](double nearer_px) {
        return contains(box_C, geometry.point(u, v, geometry.shiftedDepth(z_m[u], nearer_px)));
      };
      points += isInBox(is_level[u] ? kLevelError_px : kError_px) && !isInBox(band_px);
    }
  }
  return points >= kFewest_px;
}

}  // namespace flight_corridor
