#pragma once

#include <opencv2/core/mat.hpp>

#include "flight_corridor/box.hpp"
#include "flight_corridor/disparity_estimator.hpp"
#include "flight_corridor/stereo_geometry.hpp"

namespace flight_corridor {

/// Whether a small thing may stand unseen in the far part of a box: the depth image has a hole there, as large as a
/// thing of 12 cm looks at the box's end, amid matches of one surface. Of a ball or a leaf of a few pixels no match may
/// be left; it and what it hides from one camera leave such a hole. Beside a nearer surface that is known holes are
/// what that one hides; and where the background is told, no thing is.
/// @param box_C the box in C.
/// @param depth of geometry.size(); an empty background tells of none.
/// @param disparity of the same pair.
bool mayHideThing(const Box& box_C, const DepthImages& depth, const Disparity& disparity,
                  const StereoGeometry& geometry);

}  // namespace flight_corridor
