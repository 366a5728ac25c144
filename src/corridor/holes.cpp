#include "flight_corridor/corridor/holes.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <set>

#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/stereo/search_range.hpp"

namespace flight_corridor {

namespace {

constexpr double kStep = 1.12;          // from a depth to the next
constexpr double kJustInside = 0.999;   // of the box's end: there its rays leave it
constexpr int kPerObstacle = 6;         // pixels looked at along the smallest obstacle, at the most
constexpr double kFarthest_m = 1000.0;  // a box has an end, whatever its pose
constexpr double kNearest_m = 0.05;     // nearer no camera is in focus

/// To the nearest corner of a rectangle at a depth.
double alongAxis(const Box& box_C, const cv::Rect& at_px, double depth_m, const StereoGeometry& geometry) {
  const Eigen::Isometry3d T_F_C = box_C.T_M_F.inverse();
  double along_m = kInfinity;
  for (const int u : {at_px.x, at_px.br().x}) {
    for (const int v : {at_px.y, at_px.br().y})
      along_m = std::min(along_m, (T_F_C * geometry.point(u, v, depth_m)).x());
  }
  return std::max(0.0, along_m);
}

}  // namespace

/// Of a part of a box.
struct Holes::Volume {
  double all_m3 = 0.0, seen_m3 = 0.0, unclear_m3 = 0.0;

  void operator+=(const Volume& other) {
    all_m3 += other.all_m3;
    seen_m3 += other.seen_m3;
    unclear_m3 += other.unclear_m3;
  }
  double outOfView() const { return all_m3 > 0.0 ? std::max(0.0, 1.0 - seen_m3 / all_m3) : 1.0; }
};

/// Repeated only if the boxes differ from the last ones.
void Holes::layOut(const Fan& fan, double from_m, double smallest_m) {
  if (from_m == from_m_ && smallest_m == smallest_m_ && fan == fan_) return;
  fan_ = fan;
  from_m_ = from_m;
  smallest_m_ = smallest_m;
  planes_.clear();
  std::vector<Box> boxes;
  for (int i = 0; i < fan.size(); ++i) boxes.push_back(fan.box(i));
  const auto endOf = [](const Box& box) { return kJustInside * std::min(farthestCorner(box), kFarthest_m); };
  const auto add = [&](double depth_m, double thick_m, auto&& isAsked) {
    Plane plane;
    plane.depth_m = depth_m;
    plane.thick_m = thick_m;
    const int stride = static_cast<int>(smallest_m * geometry_.calibration().fx_px / depth_m) / kPerObstacle;
    plane.stride_px = std::max(1, stride);
    for (const Box& box : boxes) {
      plane.sections.push_back(isAsked(box) ? sectionAt(box, depth_m, geometry_) : Section());
      plane.view |= plane.sections.back().view;
    }
    plane.view.width += plane.view.x % plane.stride_px;  // for all boxes the same pixels are looked at
    plane.view.x -= plane.view.x % plane.stride_px;
    plane.view.height += plane.view.y % plane.stride_px;
    plane.view.y -= plane.view.y % plane.stride_px;
    planes_.push_back(plane);
  };
  double end_m = -kInfinity;
  for (const Box& box : boxes) end_m = std::max(end_m, endOf(box));
  for (double lower_m = kNearest_m; lower_m < end_m; lower_m *= kStep) {  // the same depths for all boxes, but ends
    const double upper_m = lower_m * kStep;
    std::set<double> ends_m;
    for (const Box& box : boxes) {
      if (lower_m < endOf(box) && endOf(box) <= upper_m) ends_m.insert(endOf(box));
    }
    for (const double depth_m : ends_m) {
      if (depth_m >= from_m) add(depth_m, depth_m - lower_m, [&](const Box& box) { return endOf(box) == depth_m; });
    }
    if (upper_m >= from_m) add(upper_m, upper_m - lower_m, [&](const Box& box) { return endOf(box) > upper_m; });
  }
}

/// A plane in the last pair's disparities.
void Holes::locate(const Plane& plane, const EarlierPairs& earlier, const ScaleCorrection& correction, double nearest_m,
                   Place& place) const {
  const StereoCalibration& rig = geometry_.calibration();
  place.at_px = static_cast<float>(geometry_.disparity(plane.depth_m));
  const double measured_px = place.at_px * correction.scale(place.at_px);
  place.first_px = static_cast<float>(firstDisparity(geometry_));
  place.measured_px = static_cast<float>(measured_px);
  place.earlier = earlier.plane(plane.depth_m);
  place.shift_px = static_cast<int>(std::lround(measured_px + geometry_.principalPointDifference()));
  place.is_searched = plane.depth_m >= nearest_m;
  const double stride_m = plane.stride_px * plane.depth_m / std::min(rig.fx_px, rig.fy_px);
  const double largest_m = kJustInside * std::min(fan_.box().size_m.y(), fan_.box().size_m.z());
  place.edge =
      std::max(1, static_cast<int>(std::ceil((std::min(kHole * smallest_m_, largest_m) - kTouch_m) / stride_m)));
}

Holes::Look Holes::look(const Plane& plane, const Section& section, const Place& place) const {
  const int stride = plane.stride_px;
  const auto strides = [stride](int pixels) { return (pixels + stride - 1) / stride; };
  const int first_u = strides(section.view.x - plane.view.x), end_u = strides(section.view.br().x - plane.view.x);
  const int first_v = strides(section.view.y - plane.view.y), end_v = strides(section.view.br().y - plane.view.y);
  if (section.view.empty() || first_u >= end_u || first_v >= end_v) return {};
  const auto sum = [&](const cv::Mat& sums, int from_u, int from_v) {
    if (from_u >= end_u || from_v >= end_v) return 0;
    return sums.at<int>(end_v, end_u) - sums.at<int>(from_v, end_u) - sums.at<int>(end_v, from_u) +
           sums.at<int>(from_v, from_u);
  };
  const int seen_from_u = std::clamp(strides(place.shift_px - plane.view.x), first_u, end_u);
  return {(end_u - seen_from_u) * (end_v - first_v), sum(unclear_sum_, first_u, first_v),
          sum(hides_sum_, first_u + place.edge - 1, first_v + place.edge - 1) > 0};
}

/// The edge of the largest square that ends at a pixel is one more than the least of its three neighbours'.
Holes::Square Holes::search(const Plane& plane, const Place& place, int direction) {
  const cv::Rect& view = plane.sections[direction].view;
  const int stride = plane.stride_px;
  const auto strides = [stride](int pixels) { return (pixels + stride - 1) / stride; };
  const int first = strides(view.x - plane.view.x), columns = strides(view.br().x - plane.view.x) - first;
  above_.assign(columns + 1, 0);
  squares_.assign(columns + 1, 0);
  Square largest;
  for (int row = strides(view.y - plane.view.y); row < strides(view.br().y - plane.view.y); ++row) {
    const auto* unclear = place.unclear.ptr(row) + first;
    const int v = plane.view.y + stride * row;
    for (int i = 1; i <= columns; ++i) {
      const int u = plane.view.x + stride * (first + i - 1);
      const bool is_unclear =
          unclear[i - 1] &&
          fan_.contains(fan_.turned(direction, fan_.T_F_C() * geometry_.point(u, v, plane.depth_m).cast<float>()));
      squares_[i] = is_unclear ? 1 + std::min({above_[i - 1], above_[i], squares_[i - 1]}) : 0;
      if (squares_[i] > largest.edge) largest = {squares_[i], u, v};
    }
    std::swap(above_, squares_);
  }
  return largest;
}

const std::vector<Unobserved>& Holes::find(const Fan& fan, const Absence& absence, const ScaleCorrection& correction,
                                           double from_m, double nearest_m, double smallest_m, double most_unclear) {
  layOut(fan, from_m, smallest_m);
  places_.resize(planes_.size());  // their images are reused
  looks_.clear();
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    const Plane& plane = planes_[i];
    locate(plane, absence.earlier, correction, nearest_m, places_[i]);
    if (!plane.view.empty()) findUnclear(plane, places_[i], absence);
    for (const Section& section : plane.sections) looks_.push_back(look(plane, section, places_[i]));
  }
  found_.clear();
  for (int direction = 0; direction < fan.size(); ++direction) {
    found_.push_back(measure(direction, most_unclear));
    findHole(direction, found_.back());
  }
  return found_;
}

Holes::Volume Holes::volume(std::size_t plane, int direction) const {
  const StereoCalibration& rig = geometry_.calibration();
  const Section& section = planes_[plane].sections[direction];
  const Look& look = looks_[plane * fan_.size() + direction];
  const double pixel_m = planes_[plane].depth_m / rig.fx_px, thick_m = planes_[plane].thick_m;
  double looked_at_m3 = std::pow(planes_[plane].stride_px * pixel_m, 2) * rig.fx_px / rig.fy_px * thick_m;
  if (look.seen > 0) looked_at_m3 = std::min(looked_at_m3, section.area_m2 * thick_m / look.seen);
  return {section.area_m2 * thick_m, look.seen * looked_at_m3, look.unclear * looked_at_m3};
}

/// Shares of a box's volume.
Unobserved Holes::measure(int direction, double most_unclear) const {
  const Box box_C = fan_.box(direction);
  const double end_m = std::min(farthestCorner(box_C), kFarthest_m), begin_m = std::max(0.0, nearestCorner(box_C));
  const double far_from_m = end_m - kEndShare * (end_m - begin_m);
  Volume all, end;
  double too_near_m3 = 0.0;
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    const Volume slice = volume(i, direction);
    all += slice;
    if (!places_[i].is_searched) too_near_m3 += slice.all_m3;
    if (planes_[i].depth_m > far_from_m) end += slice;
  }
  Unobserved measured;
  if (all.seen_m3 > 0.0) measured.fraction = all.unclear_m3 / all.seen_m3;
  measured.out_of_view = all.outOfView();
  if (all.all_m3 > 0.0) measured.too_near = too_near_m3 / all.all_m3;
  measured.end_out_of_view = end.outOfView();
  measured.unclear_along_m = unclearFrom(direction, most_unclear * all.seen_m3);
  return measured;
}

/// Where the unclear volume, added up from a box's start on, becomes larger than a limit.
double Holes::unclearFrom(int direction, double limit_m3) const {
  double unclear_m3 = 0.0;
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    unclear_m3 += volume(i, direction).unclear_m3;
    if (unclear_m3 > limit_m3) return beginOf(i, direction);
  }
  return kInfinity;
}

/// Of a plane's slice, along a box's axis.
double Holes::beginOf(std::size_t plane, int direction) const {
  const Plane& slice = planes_[plane];
  return alongAxis(fan_.box(direction), slice.sections[direction].view, slice.depth_m - slice.thick_m, geometry_);
}

/// The nearest hole that hides the smallest obstacle; space too near to be matched is not a hole.
void Holes::findHole(int direction, Unobserved& found) {
  const StereoCalibration& rig = geometry_.calibration();
  found.hole_along_m = kInfinity;
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    const Plane& plane = planes_[i];
    if (!places_[i].is_searched || !looks_[i * fan_.size() + direction].may_hide) continue;
    const Square square = search(plane, places_[i], direction);
    if (square.edge < places_[i].edge) continue;
    const int edge_px = square.edge * plane.stride_px;
    found.hole_m = edge_px * plane.depth_m / std::min(rig.fx_px, rig.fy_px);
    found.hole_depth_m = plane.depth_m;
    found.hole_px = {square.end_u - edge_px + plane.stride_px, square.end_v - edge_px + plane.stride_px, edge_px,
                     edge_px};
    found.hole_along_m = beginOf(i, direction);
    return;
  }
}

}  // namespace flight_corridor
