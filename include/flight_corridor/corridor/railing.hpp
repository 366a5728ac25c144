#pragma once

#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Whether a railing may stand in a box before the wall behind it. Equal bars match at their disparity, and at those
/// that are smaller by their pitch, too; where the wall is there, they are taken for it. Then many windows of 5 px by 5
/// px that were matched on one surface fit in the box as well, all at one same offset, and so far beside them, where
/// the next bar is, there are others of them. So do those of a fence or a net that is behind the box, but beside these
/// something is farther: no wall shows at the very distance of the pattern. And no fence's bars are as far apart as
/// those of a near railing would be there.
/// @param depth_m CV_32FC1 of the pair's size, NaN = nothing known.  @param nearest_m that is searched.
/// @param is_lidar_valid whether the LiDAR's beam meets something in the view of the box's end:
/// where nearly all windows are of the pattern, it is there. Between the bars of a railing the beam may pass.
bool mayBeRailing(const Box& box_C, const StereoFrame& pair, const cv::Mat& depth_m, double nearest_m,
                  bool is_lidar_valid, const StereoGeometry& geometry);

}  // namespace flight_corridor
