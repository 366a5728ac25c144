#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor {

/// Where the left image shows cross-sections of a box, from its end inwards to its start, each farther in than the last
/// by 0.15 times that one's distance from the camera: rectangles of pixels around them, cut to the image. Left out are,
/// but for the end, those within 0.6 m of the camera, and those out of view or below a pixel. All of the image where
/// only a part of a cross-section is behind the camera.
std::vector<cv::Rect> crossSections(const Box& box_C, const StereoGeometry& geometry);

/// The first of them: the end, where that is in view; empty where none is.
cv::Rect viewOfEnd(const Box& box_C, const StereoGeometry& geometry);

/// The second of them, a little before the end; the only one; or empty, where none is in view.
cv::Rect viewOfFarPart(const Box& box_C, const StereoGeometry& geometry);

}  // namespace flight_corridor
