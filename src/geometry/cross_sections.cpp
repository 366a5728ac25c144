#include "flight_corridor/geometry/cross_sections.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace flight_corridor {

namespace {

constexpr double kNearest_m = 0.6;  // from the camera; nearer ones see nearly all of the image
constexpr double kStep = 0.15;      // between two neighbours, of the distance from the camera

/// The rectangle around one, cut to the image; empty where it is out of view.
cv::Rect viewOf(const Box& box_C, double x_m, const StereoGeometry& geometry) {
  const cv::Size size = geometry.size();
  Eigen::AlignedBox2d view;
  int behind = 0;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d corner_F(x_m, (i & 1 ? 0.5 : -0.5) * box_C.size_m.y(),
                                   (i & 2 ? 0.5 : -0.5) * box_C.size_m.z());
    const Eigen::Vector2d pixel = geometry.project(box_C.T_M_F * corner_F);
    if (pixel.hasNaN()) {
      ++behind;
    } else {
      view.extend(pixel);
    }
  }
  if (behind > 0) return behind < 4 ? cv::Rect({}, size) : cv::Rect();
  view = view.intersection(Eigen::AlignedBox2d(Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(size.width, size.height)));
  if (view.isEmpty()) return {};
  const Eigen::Vector2i first = view.min().cast<int>(), last = view.max().cast<int>();
  return {first.x(), first.y(), last.x() - first.x(), last.y() - first.y()};
}

/// From the end inwards, those in view.
/// @param see takes a view, and returns whether it wants the next one.
template <class See>
void forEachSection(const Box& box_C, const StereoGeometry& geometry, const See& see) {
  const double end_m = box_C.size_m.x();
  for (double x_m = end_m; x_m >= 0.0;) {
    const double distance_m = (box_C.T_M_F * Eigen::Vector3d(x_m, 0.0, 0.0)).norm();
    if (x_m == end_m || distance_m >= kNearest_m) {
      if (const cv::Rect view = viewOf(box_C, x_m, geometry); !view.empty() && !see(view)) return;
    }
    if (x_m == 0.0) break;
    x_m = std::max(0.0, x_m - kStep * std::max(distance_m, kNearest_m));
  }
}

}  // namespace

std::vector<cv::Rect> crossSections(const Box& box_C, const StereoGeometry& geometry) {
  std::vector<cv::Rect> views;
  forEachSection(box_C, geometry, [&](const cv::Rect& view) {
    views.push_back(view);
    return true;
  });
  return views;
}

cv::Rect viewOfEnd(const Box& box_C, const StereoGeometry& geometry) {
  cv::Rect end;
  forEachSection(box_C, geometry, [&](const cv::Rect& view) {
    end = view;
    return false;
  });
  return end;
}

cv::Rect viewOfFarPart(const Box& box_C, const StereoGeometry& geometry) {
  cv::Rect far_part;
  int views = 0;
  forEachSection(box_C, geometry, [&](const cv::Rect& view) {
    far_part = view;
    return ++views < 2;
  });
  return far_part;
}

}  // namespace flight_corridor
