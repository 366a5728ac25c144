#pragma once

#include <opencv2/core/mat.hpp>

#include "flight_corridor/band_workers.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/stereo/disparity_evidence.hpp"
#include "flight_corridor/stereo/patches.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Section `stereo/`: the matcher.
struct StereoConfig {
  int num_disparities_px = 128;        ///< Search range, a multiple of 32.
  double min_matched_fraction = 0.08;  ///< Fewer matched pixels: no verdict FREE.
};
Violations check(const StereoConfig& config);

/// What a pair says of each pixel: matches that form patches, and their doubt.
struct Disparity : DisparityEvidence {
  double matched_fraction = 0.0;  ///< Share of pixels with a match [0..1].
};

/// Disparity of rectified pairs. One object, one thread; output buffers are reused.
class DisparityEstimator {
 public:
  /// @param smallest_obstacle_m smaller patches of matches are removed, see Patches.
  /// @throws std::invalid_argument with every broken rule, or when the image is too narrow for the search.
  DisparityEstimator(const StereoConfig& config, const StereoGeometry& geometry, double smallest_obstacle_m);

  void setSmallestObstacle(double edge_m) { patches_.setSmallestObstacle(edge_m); }

  /// @param frame both images CV_8UC1 of geometry.size().
  /// @param out refilled.
  /// @throws std::invalid_argument naming the image that is not, and why.
  void estimate(const StereoFrame& frame, Disparity& out);

  /// The same before patches are looked at.
  void match(const StereoFrame& frame, DisparityEvidence& out);

  /// Threads for further work on the pair; cv::getNumThreads() at construction.
  BandWorkers& workers() { return workers_; }

  /// Nothing nearer is found: a smaller disparity is taken for it, or none [m].
  double nearestDepth() const;

 private:
  int num_disparities_;
  StereoGeometry geometry_;
  BandWorkers workers_;
  SemiGlobalMatcher matcher_;
  Patches patches_;
};

}  // namespace flight_corridor
