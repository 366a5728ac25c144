#pragma once

#include <opencv2/core/mat.hpp>

namespace flight_corridor {

/// A pair's evidence at each pixel of the left image. All maps have the image's size; disparities are CV_32FC1 [px],
/// principal-point difference removed, NaN = no match.
struct DisparityEvidence {
  cv::Mat best_px;      ///< Sub-pixel match on which both views agree and which its own window supports.
  cv::Mat repeated_px;  ///< Such a match with kRepeated: of a pattern, at one of several candidates.
  cv::Mat flags;        ///< CV_8UC1, bits of MatchFlag.
  cv::Mat set;          ///< CV_8UC(set bytes): the disparities not contradicted, bit by bit from firstDisparity() on.
  cv::Mat competitor_farthest;  ///< CV_8UC1, where flags has kCompetitor: as bit of the set, the smallest one.
  cv::Mat competitor_nearest;   ///< The largest one.
};

}  // namespace flight_corridor
