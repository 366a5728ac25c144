#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "flight_corridor/pipeline.hpp"

namespace flight_corridor {

/// What the last pair, and those before it, show at a pixel of the left image about the corridor.
enum class Evidence : std::uint8_t {
  Outside,      ///< Its ray does not meet the corridor where both cameras see it.
  Clear,        ///< Its ray, or the right camera's, is clear all the way from where stereo begins to see.
  ClearBefore,  ///< What it does not show clear, two earlier pairs did.
  Unmatched,    ///< Not clear, for want of a match.
  Textureless,  ///< Not clear, without texture.
  Doubtful,     ///< Of a patch that is matched behind the corridor, but fits in it as well.
  Hole,         ///< In the nearest place without a clear ray that could hide the smallest obstacle.
  InBox,        ///< Matched in the corridor.
};

/// Evidence of each pixel of the left image, CV_8UC1, of the last pair that was not refused; empty before the first.
/// Not shown: gaps in bars (BarGaps), railings (Railings), and what the map or the LiDAR add.
cv::Mat evidenceOf(const Pipeline& pipeline);

/// In colours on the grey image that colour-blind people tell apart (Okabe and Ito 2008).
/// @param left CV_8UC1.  @param evidence of the same size, or empty.  @param out CV_8UC3 (BGR), refilled, same size;
/// empty without evidence.
void drawEvidence(const cv::Mat& left, const cv::Mat& evidence, cv::Mat& out);

/// What the colours mean, as a strip below a picture.  @param picture CV_8UC3, becomes higher.
void addLegend(cv::Mat& picture);

}  // namespace flight_corridor
