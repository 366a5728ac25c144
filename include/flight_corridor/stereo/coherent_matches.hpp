#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor {

/// Matches that form a patch: neighbours, also across corners, differ by a pixel of disparity at most. A patch smaller
/// than the smallest obstacle, at its own distance, is a mistake or no obstacle: it is removed. One object, one thread.
class CoherentMatches {
 public:
  /// @param smallest_obstacle_m edge of a square: patches of less than its area are removed; 0: none is.
  CoherentMatches(const StereoGeometry& geometry, double smallest_obstacle_m);

  /// @param disparity_px CV_32FC1 of geometry.size(), positive or NaN; what is removed becomes NaN.
  void keep(cv::Mat& disparity_px);

 private:
  void labelRow(int v, const float* row, const float* above);
  int root(int label);
  void join(int one, int other);

  StereoGeometry geometry_;
  cv::Size size_;
  double least_m2_;
  std::vector<int> labels_;       // a pixel: of its run along the row
  std::vector<int> parents_;      // a label: itself, or one of the same patch
  std::vector<double> areas_m2_;  // a label; whole at a root
};

}  // namespace flight_corridor
