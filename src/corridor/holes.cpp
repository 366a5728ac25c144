#include "flight_corridor/corridor/holes.hpp"

#include <algorithm>
#include <cmath>

#include "flight_corridor/geometry/section.hpp"

namespace flight_corridor {

namespace {

constexpr double kStep = 1.12;          // from a depth to the next
constexpr double kJustInside = 0.999;   // of the box's end: there its rays leave it
constexpr int kPerObstacle = 6;         // pixels looked at along the smallest obstacle, at the most
constexpr double kFarthest_m = 1000.0;  // a box has an end, whatever its pose
constexpr double kNearest_m = 0.05;     // nearer no camera is in focus
constexpr double kFarShare = 0.25;      // of the box's depth: its end

/// Of a part of a box.
struct Volume {
  double all_m3 = 0.0, seen_m3 = 0.0, unclear_m3 = 0.0;

  void operator+=(const Volume& other) {
    all_m3 += other.all_m3;
    seen_m3 += other.seen_m3;
    unclear_m3 += other.unclear_m3;
  }
  double outOfView() const { return all_m3 > 0.0 ? std::max(0.0, 1.0 - seen_m3 / all_m3) : 1.0; }
};

/// To the nearest corner of a rectangle at a depth.
double alongAxis(const Box& box_C, const cv::Rect& at_px, double depth_m, const StereoGeometry& geometry) {
  const Eigen::Isometry3d T_F_C = box_C.T_M_F.inverse();
  double along_m = kInfinity;
  for (const int u : {at_px.x, at_px.br().x}) {
    for (const int v : {at_px.y, at_px.br().y}) along_m = std::min(along_m, (T_F_C * geometry.point(u, v, depth_m)).x());
  }
  return std::max(0.0, along_m);
}

}  // namespace

/// A depth, and what is found there.
struct Holes::Plane {
  float at_px;   // corrected disparity
  int shift_px;  // from a left pixel to the right one
  int stride_px;
  bool is_searched;  // not too near to be matched
  cv::Rect view;
  int seen = 0, unclear = 0;           // of the pixels looked at
  int edge = 0, end_u = 0, end_v = 0;  // of the largest square, in strides; its last pixel
};

/// The edge of the largest square that ends at a pixel is one more than the least of its three neighbours'.
void Holes::search(Plane& plane, const BoxView& view, const ClearRays& rays) {
  const int columns = (plane.view.width + plane.stride_px - 1) / plane.stride_px;
  above_.assign(columns + 1, 0);
  squares_.assign(columns + 1, 0);
  for (int v = plane.view.y; v < plane.view.br().y; v += plane.stride_px) {
    const auto *entry = view.entry().ptr<float>(v), *exit = view.exit().ptr<float>(v);
    for (int i = 1, u = plane.view.x; i <= columns; ++i, u += plane.stride_px) {
      const bool is_seen = exit[u] <= plane.at_px && plane.at_px <= entry[u] && plane.shift_px <= u;
      const bool is_unclear = is_seen && !(plane.is_searched && rays.isClear(u, v, plane.at_px, plane.shift_px));
      plane.seen += is_seen;
      plane.unclear += is_unclear;
      squares_[i] = is_unclear ? 1 + std::min({above_[i - 1], above_[i], squares_[i - 1]}) : 0;
      if (squares_[i] > plane.edge) plane.edge = squares_[i], plane.end_u = u, plane.end_v = v;
    }
    std::swap(above_, squares_);
  }
}

Unobserved Holes::find(const Box& box_C, const BoxView& view, const ClearRays& rays, const ScaleCorrection& correction,
                       double from_m, double nearest_m, double smallest_m) {
  const StereoCalibration& rig = geometry_.calibration();
  const double end_m = std::min(farthestCorner(box_C), kFarthest_m), begin_m = std::max(0.0, nearestCorner(box_C));
  const double far_from_m = end_m - kFarShare * (end_m - begin_m);
  Volume all, end;
  double too_near_m3 = 0.0;
  Unobserved found;
  found.first_hole_m = kInfinity;
  for (double depth_m = kJustInside * end_m; depth_m >= std::max(from_m, kNearest_m); depth_m /= kStep) {
    const Section section = sectionAt(box_C, depth_m, geometry_);
    const double pixel_m = depth_m / rig.fx_px, thick_m = depth_m * (1.0 - 1.0 / kStep);
    Plane plane{};
    plane.view = section.view;
    plane.at_px = static_cast<float>(geometry_.disparity(depth_m));
    const double measured_px = plane.at_px * correction.scale(plane.at_px);
    plane.shift_px = static_cast<int>(std::lround(measured_px + geometry_.principalPointDifference()));
    plane.stride_px = std::max(1, static_cast<int>(smallest_m / pixel_m) / kPerObstacle);
    plane.is_searched = depth_m >= nearest_m;
    search(plane, view, rays);
    double looked_at_m3 = std::pow(plane.stride_px * pixel_m, 2) * rig.fx_px / rig.fy_px * thick_m;
    if (plane.seen > 0) looked_at_m3 = std::min(looked_at_m3, section.area_m2 * thick_m / plane.seen);
    const Volume volume{section.area_m2 * thick_m, plane.seen * looked_at_m3, plane.unclear * looked_at_m3};
    all += volume;
    if (!plane.is_searched) too_near_m3 += volume.all_m3;
    if (depth_m > far_from_m) end += volume;
    const int edge_px = plane.edge * plane.stride_px;
    const double edge_m = edge_px * depth_m / std::min(rig.fx_px, rig.fy_px);
    if (!plane.is_searched) continue;
    const cv::Rect hole_px(plane.end_u - edge_px + plane.stride_px, plane.end_v - edge_px + plane.stride_px, edge_px,
                           edge_px);
    if (edge_m >= kHole * smallest_m - kTouch_m) found.first_hole_m = alongAxis(box_C, hole_px, depth_m, geometry_);
    if (edge_m <= found.hole_m) continue;
    found.hole_m = edge_m;
    found.hole_depth_m = depth_m;
    found.hole_px = hole_px;
  }
  if (all.seen_m3 > 0.0) found.fraction = all.unclear_m3 / all.seen_m3;
  found.out_of_view = all.outOfView();
  if (all.all_m3 > 0.0) found.too_near = too_near_m3 / all.all_m3;
  found.end_out_of_view = end.outOfView();
  return found;
}

}  // namespace flight_corridor
