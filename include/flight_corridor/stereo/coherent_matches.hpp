#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/band_workers.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor {

/// Matches that form a patch: neighbours, also across corners, differ by a pixel of disparity at most. A patch smaller
/// than the smallest obstacle, at its own distance, is a mistake or no obstacle: it is removed. An outline, all that a
/// bare obstacle shows, need only be as long as the smallest obstacle. A patch most of which is repeated is repeated as
/// a whole. One object, one thread.
class CoherentMatches {
 public:
  /// @param smallest_obstacle_m edge of a square: patches whose best matches show less than it lose these; 0: none.
  /// @param threads that work, the caller's included; the result does not depend on them.
  CoherentMatches(const StereoGeometry& geometry, double smallest_obstacle_m, int threads);

  void setSmallestObstacle(double edge_m) { smallest_m_ = edge_m; }

  /// @param best_px, repeated_px CV_32FC1 of geometry.size(), positive or NaN, a match in one of the two.
  /// @return number of best matches that stay.
  int keep(cv::Mat& best_px, cv::Mat& repeated_px);

 private:
  /// What a patch covers, and how much of that is of repeated matches.
  struct Area {
    double all_m2 = 0.0, repeated_m2 = 0.0;
  };

  void labelRow(int v, const cv::Mat& best_px, const cv::Mat& repeated_px);
  void joinWithAbove(int v);
  int keepRow(int v, cv::Mat& best_px, cv::Mat& repeated_px) const;
  int root(int label);
  void join(int one, int other);

  StereoGeometry geometry_;
  int width_, bands_;
  double smallest_m_;
  cv::Mat matches_px_;        // of either kind
  std::vector<int> labels_;   // a pixel: the first one of its run along the row, if any
  std::vector<int> parents_;  // a label: itself, or one of the same patch
  std::vector<Area> areas_;   // a label; whole at a root
  std::vector<int> kept_;     // a band
  BandWorkers workers_;       // last: they use all of the above
};

}  // namespace flight_corridor
