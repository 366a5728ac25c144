#pragma once

#include <opencv2/core/mat.hpp>

#include "flight_corridor/box.hpp"
#include "flight_corridor/stereo_geometry.hpp"

namespace flight_corridor {

/// Whether a level edge lies so little behind a box, as it was matched, that it may be in it: only its slope tells how
/// far it is. In simulation 95 of 100 pixels of branches were matched no more than 1 px too far.
/// @param box_C the box in C.
/// @param depth_m CV_32FC1 of geometry.size(), NaN = nothing.
/// @param level CV_8U of that size, not 0 at level edges.
/// @param band_px disparity by which the map takes them to be nearer: those that this brings into the box are judged
/// there.
bool mayHoldLevelEdge(const Box& box_C, const cv::Mat& depth_m, const cv::Mat& level, const StereoGeometry& geometry,
                      double band_px);

}  // namespace flight_corridor
