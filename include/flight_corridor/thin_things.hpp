#pragma once

#include <opencv2/core/mat.hpp>

#include "flight_corridor/box.hpp"
#include "flight_corridor/disparity_estimator.hpp"
#include "flight_corridor/stereo_geometry.hpp"

namespace flight_corridor {

/// Whether a thin thing lies so little behind a box, as it was matched, that it may be in it: what is around draws its
/// matches to itself, and of a level edge only the slope tells how far it is. In simulation 95 of 100 pixels of level
/// branches were matched no more than 1 px too far. And whether a leaf of a few pixels may be in it, some of them
/// matched in it and some with what is around. A pixel counts less the nearer it is, by the area that it shows.
/// @param box_C the box in C, in which the map shows nothing.
/// @param depth_m CV_32FC1 of geometry.size(), of the disparity's matches, NaN = nothing.
/// @param band_px disparity by which the map takes all things to be nearer: what this brings into the box is judged
/// there.
bool mayHoldThinThing(const Box& box_C, const cv::Mat& depth_m, const Disparity& disparity,
                      const StereoGeometry& geometry, double band_px);

}  // namespace flight_corridor
