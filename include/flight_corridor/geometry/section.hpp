#pragma once

#include <opencv2/core/types.hpp>

#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor {

/// The section of a box at one depth.
struct Section {
  cv::Rect view;         ///< Around it on the left image, clipped; empty if out of view.
  double area_m2 = 0.0;  ///< Of the rectangle around it, parallel to the image.
};

/// @param depth_m along z of C.
Section sectionAt(const Box& box_C, double depth_m, const StereoGeometry& geometry);

/// Views of a box's end, and of the section before it by 15 % of the end's depth.
cv::Rect viewOfEnd(const Box& box_C, const StereoGeometry& geometry);
cv::Rect viewOfFarPart(const Box& box_C, const StereoGeometry& geometry);

}  // namespace flight_corridor
