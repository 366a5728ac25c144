#pragma once

#include <opencv2/core/mat.hpp>

#include "flight_corridor/box.hpp"
#include "flight_corridor/stereo_geometry.hpp"

namespace flight_corridor {

/// Whether something small lies so little behind the end of a box that points away from the camera that it may reach
/// into it: the corner of a thing that comes in from the side, or the tip of a leaf. Of what reaches in no more than a
/// few pixels are left, and what is around draws them to itself. A wall has thousands, the nearest of which are in the
/// box first: where much of the view of the box's end shows something close behind it, nothing is small.
/// @param box_C the box in C, in which the map shows nothing.
/// @param depth_m CV_32FC1 of geometry.size(), matched or filled, NaN = nothing.
/// @param band_px disparity by which the map takes all things to be nearer: what this brings into the box, or up to 4 px
/// beside it, is left to the map.
bool mayBeGrazed(const Box& box_C, const cv::Mat& depth_m, const StereoGeometry& geometry, double band_px);

}  // namespace flight_corridor
