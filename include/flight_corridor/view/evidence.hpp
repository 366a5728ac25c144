#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "flight_corridor/pipeline.hpp"

namespace flight_corridor {

/// What the last pair, and those before it, show at a pixel of the left image about the corridor.
enum class Evidence : std::uint8_t {
  Outside,     ///< Its ray does not meet the corridor.
  Clear,       ///< Its ray, or the right camera's, is clear all the way.
  Remembered,  ///< What it does not show clear, two earlier pairs did.
  Unmatched,   ///< Not clear, for want of a match.
  Bare,        ///< Not clear, without texture.
  Doubtful,    ///< Matched behind the corridor, but fits in it as well.
  Hole,        ///< In the nearest place without a clear ray that could hide the smallest obstacle.
  Match,       ///< Matched in the corridor.
};

/// Evidence of each pixel of the left image, CV_8UC1; empty before the first frame.
cv::Mat evidenceOf(const Pipeline& pipeline);

/// In colours on the grey image that colour-blind people tell apart (Okabe and Ito 2008).
/// @param left CV_8UC1.  @param evidence of the same size.  @param out CV_8UC3 (BGR), refilled, same size.
void drawEvidence(const cv::Mat& left, const cv::Mat& evidence, cv::Mat& out);

/// What the colours mean, as a strip below a picture.  @param picture CV_8UC3, becomes higher.
void addLegend(cv::Mat& picture);

}  // namespace flight_corridor
