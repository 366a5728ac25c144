#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/stereo/coherent_matches.hpp"
#include "flight_corridor/stereo/disparity_evidence.hpp"
#include "flight_corridor/stereo/opencv_matcher.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Section `stereo/`: the matcher.
struct StereoConfig {
  std::string engine = "semi_global";  ///< semi_global: our own; opencv: the paper's SGBM and WLS filter.
  int num_disparities_px = 128;        ///< Search range, a multiple of 32.
  double min_matched_fraction = 0.08;  ///< Fewer matched pixels: no verdict FREE.
  OpencvConfig opencv;                 ///< In the section's own keys.
};
Violations check(const StereoConfig& config);

/// What a pair says of each pixel: matches that are coherent, and their doubt.
struct Disparity : DisparityEvidence {
  double matched_fraction = 0.0;  ///< Share of pixels with a match [0..1].
};

/// Disparity of rectified pairs. One object, one thread; output buffers are reused.
class DisparityEstimator {
 public:
  /// @param smallest_obstacle_m smaller patches of matches are removed, see CoherentMatches.
  /// @throws std::invalid_argument with every broken rule, or when the image is too narrow for the search.
  DisparityEstimator(const StereoConfig& config, const StereoGeometry& geometry, double smallest_obstacle_m);

  void setSmallestObstacle(double edge_m) { coherent_.setSmallestObstacle(edge_m); }

  /// @param frame both images CV_8UC1 of geometry.size().
  /// @param out refilled.
  void estimate(const StereoFrame& frame, Disparity& out);

  /// Where in C a surface is on both images. Also where it is too near for the disparities searched.
  ConvexRegion observable() const;

  /// Nothing nearer is found: a smaller disparity is taken for it, or none [m].
  double nearestDepth() const;

 private:
  int num_disparities_;
  StereoGeometry geometry_;
  std::unique_ptr<EvidenceMatcher> semi_global_;  // one of the two
  std::unique_ptr<OpencvMatcher> opencv_;
  CoherentMatches coherent_;
};

}  // namespace flight_corridor
