#pragma once

#include <opencv2/core/mat.hpp>

namespace flight_corridor {

/// The right image with the left one's mean and contrast, of the ranks that neither camera clips: cameras that expose
/// by themselves differ. What is white in both, as the sky, stays white. Unchanged where too little is left unclipped.
/// @param left, right CV_8UC1 of one size.  @param balanced_right refilled.
void balanceExposure(const cv::Mat& left, const cv::Mat& right, cv::Mat& balanced_right);

}  // namespace flight_corridor
