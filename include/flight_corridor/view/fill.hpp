#pragma once

#include <opencv2/core/mat.hpp>

#include "flight_corridor/pipeline.hpp"

namespace flight_corridor {

/// Disparity for display: matches, and between them values interpolated along the image's edges (fast global smoother:
/// Min et al. 2014). Not evidence.
/// @param left CV_8UC1.  @param matched_px CV_32FC1 of the same size, NaN = no match.  @param filled_px refilled; NaN
/// without a match nearby.
void fillDisparity(const cv::Mat& left, const cv::Mat& matched_px, cv::Mat& filled_px);

/// The filled disparity of the last frame, CV_32FC1 [px]; NaN before the first.
cv::Mat filledDisparity(const Pipeline& pipeline);

/// Its depth along z of C, scale-corrected, CV_32FC1 [m].
cv::Mat filledDepth(const Pipeline& pipeline);

}  // namespace flight_corridor
