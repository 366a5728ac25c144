#pragma once

#include "flight_corridor/box.hpp"
#include "flight_corridor/disparity_estimator.hpp"
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

/// Whether a railing may stand in a box before the wall behind it. Equal bars match at their disparity, and at those
/// that are smaller by their pitch, too; where the wall is there, they are taken for it. Then many windows of 5 px by 5
/// px that were matched on one surface fit in the box as well, all at one same offset, and so far beside them, where
/// the next bar is, there are others of them. So do those of a fence or a net that is behind the box, but beside these
/// something is farther: no wall shows at the very distance of the pattern. And no fence's bars are as far apart as those
/// of a near railing would be there.
/// @param disparity of the pair.  @param is_told whether the LiDAR's beam meets something in the view of the box's end:
/// where nearly all windows are of the pattern, it is there. Between the bars of a railing the beam may pass.
bool mayBeRailing(const Box& box_C, const StereoFrame& pair, const Disparity& disparity, const cv::Mat& depth_m,
                  double nearest_m, bool is_told, const StereoGeometry& geometry);

}  // namespace flight_corridor
