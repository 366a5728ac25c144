#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/band_workers.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor {

/// Matches that form a patch: neighbours, also across corners, differ by a pixel of disparity at most. A patch smaller
/// than the smallest obstacle, at its own distance, is a mismatch or no obstacle: it is removed. The outline of a
/// textureless obstacle need only be as long as the smallest obstacle. A patch of mostly repeated matches is repeated
/// as a whole. One object, one thread.
class Patches {
 public:
  /// @param smallest_obstacle_m edge of a square: patches whose best matches show less than it lose these; 0: none.
  /// @param workers must outlive it; the result does not depend on them.
  Patches(const StereoGeometry& geometry, double smallest_obstacle_m, BandWorkers& workers);

  void setSmallestObstacle(double edge_m) { smallest_m_ = edge_m; }

  /// @param best_px, repeated_px CV_32FC1 of geometry.size(), positive or NaN, a match in one of the two.
  /// @return number of best matches kept.
  int keep(cv::Mat& best_px, cv::Mat& repeated_px);

 private:
  /// Neighbours of one surface along a row; at a patch's root, with the areas of all joined runs.
  struct Run {
    int first_u, end_u, best;  ///< Pixels, and the number of best matches among them.
    double all_m2, repeated_m2;
  };

  void findRuns(int v, const cv::Mat& best_px, const cv::Mat& repeated_px);
  void joinWithAbove(int v, const cv::Mat& best_px, const cv::Mat& repeated_px);
  int keepRow(int v, cv::Mat& best_px, cv::Mat& repeated_px) const;
  void join(int one, int other);
  int label(int v) const { return v * geometry_.size().width; }  // of a row's first run

  StereoGeometry geometry_;
  double smallest_m_;
  int bands_;
  std::vector<Run> runs_;     // a label; those of row v from label(v) on
  std::vector<int> end_;      // a row: one behind its last label
  std::vector<int> parents_;  // a label: see rootOf()
  std::vector<int> kept_;     // a band
  BandWorkers& workers_;
};

}  // namespace flight_corridor
