#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor {

/// The depth up to which the rays of an image rectangle are free, in near constant time: minima over overlapping
/// squares of tiles (a sparse table, Bender and Farach-Colton 2000), tiles of kTile_px x kTile_px pixels. Rectangles
/// are widened to whole tiles, so that an answer never omits a requested ray.
class DepthPyramid {
 public:
  static constexpr int kTile_px = 4;  // squares in which free space is resolved

  /// @param depth_m CV_32FC1, depth of the surface at each pixel; NaN = no ray.
  /// @param free_band_px a ray is free up to the point whose disparity is larger than its surface's by this.
  /// @param min_tile_fraction share of a tile's pixels that must have a ray.
  void build(const cv::Mat& depth_m, const StereoGeometry& geometry, double free_band_px, double min_tile_fraction);

  /// The shortest free ray of a non-empty rectangle of tiles; +inf without a ray.
  float nearest(const cv::Rect& tiles) const { return least(nearest_m_, tiles); }

  /// The largest nearest() of the tiles of a rectangle that hold a ray; 0 without a ray.
  float farthest(const cv::Rect& tiles) const { return -least(minus_farthest_m_, tiles); }

  /// How many of a rectangle's tiles hold too few rays.
  int unusable(const cv::Rect& tiles) const;

 private:
  using Squares = std::vector<cv::Mat1f>;  // [level](row, column): least of 2^level x 2^level tiles from there on

  void joinSquares(Squares& squares) const;
  static float least(const Squares& squares, const cv::Rect& tiles);

  Squares nearest_m_, minus_farthest_m_;
  cv::Mat1i unusable_sum_;  // tiles above and left that hold too few rays
};

}  // namespace flight_corridor
