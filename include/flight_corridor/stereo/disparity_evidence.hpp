#pragma once

#include <opencv2/core/mat.hpp>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Bounds lie outside the whole disparities that they enclose, by half a pixel of rounding and half a pixel of noise.
constexpr float kBoundSlack_px = 1.0f;

/// What a pair says of each pixel of the left image. All maps have the image's size; disparities are CV_32FC1 [px],
/// principal-point difference removed, NaN = none.
struct DisparityEvidence {
  cv::Mat best_px;      ///< Sub-pixel match on which both views agree and which its own window supports.
  cv::Mat repeated_px;  ///< Such a match that has a distinct competitor farther away: of a pattern, nobody knows where.
  cv::Mat farthest_px;  ///< Smallest disparity that the images do not contradict, less kBoundSlack_px.
  cv::Mat nearest_px;   ///< Largest one, plus kBoundSlack_px.
  cv::Mat competitor_farthest_px;  ///< Smallest of the distinct competitors of the best match, whole pixels.
  cv::Mat competitor_nearest_px;   ///< Largest of them.
  cv::Mat flags;                   ///< CV_8UC1, bits of MatchFlag.
  cv::Mat set;  ///< CV_8UC(set bytes): the disparities not contradicted, bit by bit from firstDisparity() on.
};

/// Finds the evidence of one rectified pair. One object, one caller at a time; outputs and scratch are reused.
class EvidenceMatcher {
 public:
  /// @param num_disparities searched, a multiple of 32, up to kLargestDisparities.
  /// @param threads that work, the caller's included.
  /// @throws std::invalid_argument naming what is impossible.
  EvidenceMatcher(const StereoGeometry& geometry, int num_disparities, int threads);

  /// @param frame both images CV_8UC1 of geometry.size().  @param out refilled.
  /// @throws std::invalid_argument naming the image that is not, and why.
  void match(const StereoFrame& frame, DisparityEvidence& out);

 private:
  void create(DisparityEvidence& out);
  void toPixels(int first, int end, DisparityEvidence& out) const;

  cv::Size size_;
  double first_px_;
  int set_bytes_;
  SemiGlobalMatcher matcher_;
  cv::Mat farthest_, nearest_, competitor_farthest_, competitor_nearest_;  // indices
};

}  // namespace flight_corridor
