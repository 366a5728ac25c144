#include "flight_corridor/level_edges.hpp"

#include <cstdint>

namespace flight_corridor {

namespace {

constexpr double kError_px = 1.0;  // of a match, at the most
constexpr int kFewest_px = 12;     // as of a run of level matches: fewer are chance

}  // namespace

bool mayHoldLevelEdge(const Box& box_C, const cv::Mat& depth_m, const cv::Mat& level, const StereoGeometry& geometry,
                      double band_px) {
  int points = 0;
  for (int v = 0; v < level.rows; ++v) {
    const auto* is_level = level.ptr<std::uint8_t>(v);
    const auto* z_m = depth_m.ptr<float>(v);
    for (int u = 0; u < level.cols; ++u) {
      if (!is_level[u] || !(z_m[u] > 0.0f)) continue;
      const auto isInBox = [&](double nearer_px) {
        return contains(box_C, geometry.point(u, v, geometry.shiftedDepth(z_m[u], nearer_px)));
      };
      points += isInBox(kError_px) && !isInBox(band_px);
    }
  }
  return points >= kFewest_px;
}

}  // namespace flight_corridor
