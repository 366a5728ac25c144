#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace flight_corridor {

/// Parts of the UAV that the left camera sees: propellers, a guard ring, landing gear.
struct OwnParts {
  cv::Mat mask;      ///< CV_8UC1 of the left image's size, 0: a part covers the view; empty: none does.
  std::string name;  ///< Of the mask, for messages.
};

/// The pixels that say nothing of the space beyond: the covered ones, and those beside them whose match or texture
/// rests on a covered one as well.
/// @return CV_8UC1 of the image's size, 255 there; empty if there is no mask.
/// @throws std::invalid_argument naming the mask, if it has another size or type, or leaves nothing in view.
cv::Mat coveredPixels(const OwnParts& parts, const cv::Size& image_px);

}  // namespace flight_corridor
