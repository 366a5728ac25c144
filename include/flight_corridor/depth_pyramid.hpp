#pragma once

#include <algorithm>
#include <cstddef>
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

  /// Rectangle of tiles, its last column and row included. Not empty, inside the image.
  struct Tiles {
    int left, top, right, bottom;
  };

  /// @param depth_m CV_32FC1, depth of the surface at each pixel; NaN = no ray.
  /// @param free_band_px a ray is free up to where its surface's disparity would be larger by this.
  /// @param min_ray_fraction share of a tile's pixels that must have a ray.
  void build(const cv::Mat& depth_m, const StereoGeometry& geometry, double free_band_px, double min_ray_fraction);

  /// The least free ray of a rectangle; +inf when there is none.
  float nearest(const Tiles& tiles) const {
    return overSquares(nearest_m_, tiles, [](float a, float b) { return std::min(a, b); });
  }

  /// The least free ray of the most free tile; 0 when there is none.
  float farthest(const Tiles& tiles) const {
    return overSquares(farthest_m_, tiles, [](float a, float b) { return std::max(a, b); });
  }

  /// Share of the rectangle's tiles that hold rays enough [0..1].
  double usableFraction(const Tiles& tiles) const;

 private:
  void buildTiles(const cv::Mat& depth_m, double min_ray_fraction);
  void addRow(const float* depth_m);
  void endTileRow(int tile_row, int height_px, int width_px, double min_ray_fraction);
  void joinSquares(int level);

  /// The least or most of the squares that cover a rectangle: one in each of its corners, and between them when it is
  /// long.
  template <class Better>
  float overSquares(const std::vector<float>& values, const Tiles& tiles, const Better& better) const {
    const int width = tiles.right - tiles.left + 1, height = tiles.bottom - tiles.top + 1;
    const int level = level_of_[std::min(width, height)], side = 1 << level;
    const float* first = values.data() + static_cast<std::ptrdiff_t>(level * rows_ + tiles.top) * columns_ + tiles.left;
    const int right = width - side, down = (height - side) * columns_;
    float best = better(better(first[0], first[right]), better(first[down], first[down + right]));
    for (int i = side; i < right; i += side) best = better(best, better(first[i], first[down + i]));
    for (int i = side * columns_; i < down; i += side * columns_)
      best = better(best, better(first[i], first[right + i]));
    return best;
  }

  int columns_ = 0, rows_ = 0, levels_ = 0;
  std::vector<int> level_of_;         // of the largest square that fits into a rectangle, by its shorter side
  std::vector<float> nearest_m_;      // [level][row][column]: over 2^level x 2^level tiles from there on
  std::vector<float> farthest_m_;     // likewise
  std::vector<std::uint8_t> usable_;  // per tile: rays enough
  cv::Mat usable_sum_;                // CV_32SC1 integral image of usable_
  std::vector<float> column_near_m_;  // scratch, per pixel column of a row of tiles
  std::vector<int> column_rays_;
};

}  // namespace flight_corridor
