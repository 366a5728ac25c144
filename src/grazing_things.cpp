#include "flight_corridor/grazing_things.hpp"

#include <opencv2/core.hpp>

#include "flight_corridor/cross_sections.hpp"

namespace flight_corridor {

namespace {

constexpr double kError_px = 0.5, kEdge_px = 4.0;  // of a small thing's match, and of its edge's place, at the most
constexpr double kClose_px = 0.8;                  // no farther behind the end is close
constexpr double kSmall = 0.25;                    // share of the end's view that small things fill, at the most
constexpr int kFewest_px = 12;                     // fewer are chance

}  // namespace

bool mayBeGrazed(const Box& box_C, const cv::Mat& depth_m, const StereoGeometry& geometry, double band_px) {
  const cv::Rect end = viewOfEnd(box_C, geometry);
  if (depth_m.empty() || end.empty()) return false;
  const double end_m = farthestCorner(box_C), close_m = geometry.shiftedDepth(end_m, -kClose_px);
  const double beside_m = kEdge_px * end_m / geometry.calibration().fx_px;
  const Eigen::Vector3d reach_m = box_C.size_m + 2.0 * beside_m * Eigen::Vector3d(0.0, 1.0, 1.0);
  const Eigen::Isometry3d T_F_C = box_C.T_M_F.inverse();
  const cv::Point beside(static_cast<int>(kEdge_px), static_cast<int>(kEdge_px));
  const cv::Rect area = cv::Rect(end.tl() - beside, end.br() + beside) & cv::Rect({}, depth_m.size());
  int grazing = 0, close = 0;
  for (int v = area.y; v < area.br().y; ++v) {
    const auto* z_m = depth_m.ptr<float>(v);
    for (int u = area.x; u < area.br().x; ++u) {
      if (!(0.0f < z_m[u] && z_m[u] <= close_m)) continue;
      const auto isIn = [&](const Eigen::Vector3d& size_m, double nearer_px) {
        return contains(size_m, T_F_C * geometry.point(u, v, geometry.shiftedDepth(z_m[u], nearer_px)));
      };
      if (isIn(reach_m, band_px)) continue;
      grazing += isIn(reach_m, kError_px);
      close += isIn(box_C.size_m, kClose_px);
    }
  }
  return grazing >= kFewest_px && close < kSmall * end.area();
}

}  // namespace flight_corridor
