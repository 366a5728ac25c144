#pragma once

#include <algorithm>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/stereo_geometry.hpp"

namespace flight_corridor {

/// Up to where the rays of an image rectangle are free, in near constant time: minima and maxima over overlapping
/// squares of tiles (a sparse table, Bender and Farach-Colton 2000, of squares alone), tiles of kTile_px x kTile_px
/// pixels. Rectangles are widened to whole tiles, so that an answer never leaves out a ray that was asked for.
class DepthPyramid {
 public:
  static constexpr int kTile_px = 4;

  /// Rectangle of tiles, its last column and row included.
  struct Tiles {
    int left, top, right, bottom;
  };

  /// Up to where the rays of a rectangle are free.
  struct Reach {
    float nearest_m;   ///< The least free ray; +inf when there is none.
    float farthest_m;  ///< The least free ray of the most free tile; 0 when there is none.
  };

  /// @param depth_m CV_32FC1, depth of the surface at each pixel; NaN = no ray.
  /// @param free_band_px a ray is free up to where its surface's disparity would be larger by this.
  /// @param min_ray_fraction share of a tile's pixels that must have a ray.
  void build(const cv::Mat& depth_m, const StereoGeometry& geometry, double free_band_px, double min_ray_fraction);

  /// @param tiles not empty, inside the image.
  Reach reach(const Tiles& tiles) const;

  /// Share of the rectangle's tiles that hold rays enough [0..1].
  double usableFraction(const Tiles& tiles) const;

 private:
  struct Square {
    float nearest_m, minus_farthest_m;  // negated, so that both are minima
  };
  static Square least(const Square& a, const Square& b) {
    return {std::min(a.nearest_m, b.nearest_m), std::min(a.minus_farthest_m, b.minus_farthest_m)};
  }

  void buildTiles(const cv::Mat& depth_m, double min_ray_fraction);
  void endTileRow(int tile_row, int height_px, int width_px, double min_ray_fraction);
  void joinSquares(int level);

  int columns_ = 0, rows_ = 0, levels_ = 0;
  std::vector<Square> squares_;       // [level][row][column]: over 2^level x 2^level tiles from there on
  std::vector<std::uint8_t> usable_;  // per tile: rays enough
  cv::Mat usable_sum_;                // CV_32SC1 integral image of usable_
  std::vector<float> column_near_m_;  // scratch, per pixel column of a row of tiles
  std::vector<int> column_rays_;
};

}  // namespace flight_corridor
