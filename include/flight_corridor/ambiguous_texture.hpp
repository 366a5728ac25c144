#pragma once

#include "flight_corridor/box.hpp"
#include "flight_corridor/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Whether most of what is known around a box's end would fit in the box as well as behind it, where it was matched: a
/// pattern that repeats itself has several good matches, and the images do not tell which is right. A match that is as
/// good as the best at or behind the surface counts, with a worse one between the two.
/// @param box_C in C.  @param depth_m CV_32FC1, NaN = nothing known; of the pair's size.
/// @param nearest_m that is searched.
bool hasAmbiguousTexture(const Box& box_C, const StereoFrame& pair, const cv::Mat& depth_m, double nearest_m,
                         const StereoGeometry& geometry);

}  // namespace flight_corridor
