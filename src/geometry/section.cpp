#include "flight_corridor/geometry/section.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr double kFarPart = 0.85;  // of the end's depth

Eigen::Vector3d corner(const Box& box_C, int i) {
  const Eigen::Vector3d share(i & 1 ? 1.0 : 0.0, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
  return box_C.T_M_F * box_C.size_m.cwiseProduct(share);
}

/// Of the middles of its ends the farther one's.
double depthOfEnd(const Box& box_C) {
  return std::max(box_C.T_M_F.translation().z(), (box_C.T_M_F * Eigen::Vector3d(box_C.size_m.x(), 0.0, 0.0)).z());
}

double depthOfBegin(const Box& box_C) {
  return std::min(box_C.T_M_F.translation().z(), (box_C.T_M_F * Eigen::Vector3d(box_C.size_m.x(), 0.0, 0.0)).z());
}

}  // namespace

Section sectionAt(const Box& box_C, double depth_m, const StereoGeometry& geometry) {
  Section section;
  if (!(depth_m > 0.0)) return section;
  Eigen::AlignedBox2d around_m, view;
  for (int i = 0; i < 8; ++i) {
    for (const int axis : {1, 2, 4}) {
      if (i & axis) continue;
      const Eigen::Vector3d one = corner(box_C, i), other = corner(box_C, i | axis);
      const double share = std::abs(other.z() - one.z()) > kTouch_m
                               ? (depth_m - one.z()) / (other.z() - one.z())
                               : (std::abs(depth_m - one.z()) <= kTouch_m ? 0.0 : -1.0);
      if (!(0.0 <= share && share <= 1.0)) continue;
      const Eigen::Vector3d point = one + share * (other - one);
      around_m.extend(Eigen::Vector2d(point.head<2>()));
      view.extend(geometry.project(point));
    }
  }
  if (view.isEmpty()) return section;
  section.area_m2 = around_m.sizes().prod();
  const cv::Size size = geometry.size();
  view =
      view.intersection(Eigen::AlignedBox2d(Eigen::Vector2d::Zero(), Eigen::Vector2d(size.width - 1, size.height - 1)));
  if (view.isEmpty()) return section;
  const Eigen::Vector2i first = view.min().array().floor().cast<int>(), last = view.max().array().ceil().cast<int>();
  section.view = {first.x(), first.y(), last.x() - first.x() + 1, last.y() - first.y() + 1};
  return section;
}

cv::Rect viewOfEnd(const Box& box_C, const StereoGeometry& geometry) {
  return sectionAt(box_C, depthOfEnd(box_C), geometry).view;
}

cv::Rect viewOfFarPart(const Box& box_C, const StereoGeometry& geometry) {
  return sectionAt(box_C, std::max(depthOfBegin(box_C), kFarPart * depthOfEnd(box_C)), geometry).view;
}

}  // namespace flight_corridor
