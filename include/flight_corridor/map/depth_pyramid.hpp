#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"

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

  /// Eight rectangles, side by side so that the compiler vectorises over them.
  struct EightTiles {
    int left[8], top[8], right[8], bottom[8];
    Tiles operator[](unsigned i) const { return {left[i], top[i], right[i], bottom[i]}; }
    int area(unsigned i) const { return (right[i] - left[i] + 1) * (bottom[i] - top[i] + 1); }
  };

  /// @param depth_m CV_32FC1, depth of the surface at each pixel; NaN = no ray.
  /// @param free_band_px a ray is free up to where its surface's disparity would be larger by this.
  /// @param min_tile_fraction share of a tile's pixels that must have a ray.
  void build(const cv::Mat& depth_m, const StereoGeometry& geometry, double free_band_px, double min_tile_fraction);

  /// The least free ray of a rectangle; +inf when there is none.
  float nearest(const Tiles& tiles) const {
    return overBlocks(nearest_m_, tiles, [](float a, float b) { return std::min(a, b); });
  }

  /// nearest() of each.
  void nearest(const EightTiles& tiles, float (&nearest_m)[8]) const;

  /// Bound of nearest() over the rectangles within one that hold a ray and are at least `least_tiles` wide and high:
  /// the most of the least of its squares of so many tiles, or of fewer. 0 when there is no ray.
  float farthest(const Tiles& tiles, int least_tiles) const {
    const int level = std::min(levelOf(least_tiles), kWindows - 1), shrink = (1 << level) - 1;
    const Tiles corners{tiles.left, tiles.top, std::max(tiles.left, tiles.right - shrink),
                        std::max(tiles.top, tiles.bottom - shrink)};
    return overBlocks(farthest_m_[level], corners, [](float a, float b) { return std::max(a, b); });
  }

  /// How many of each rectangle's tiles hold too few rays.
  void unusable(const EightTiles& tiles, int (&unusable)[8]) const;

 private:
  void buildTiles(const cv::Mat& depth_m, double min_tile_fraction);
  void addRow(const float* depth_m);
  void buildFarthest(int window);
  void endTileRow(int tile_row, int height_px, int width_px, double min_tile_fraction);
  template <class Better>
  void joinBlocks(std::vector<float>& values, const Better& better);

  static constexpr int kLevels = 3;   // of blocks per axis: 1, 2, 4 tiles. Larger rectangles are asked for seldom
  static constexpr int kWindows = 2;  // of farthest(): squares of 1, 2 tiles

  /// Of the largest block that fits along an axis.
  static int levelOf(int tiles) { return std::min(31 - __builtin_clz(static_cast<unsigned>(tiles)), kLevels - 1); }

  /// The least or most of the blocks that cover a rectangle: one in each of its corners, and more when it is large.
  template <class Better>
  float overBlocks(const std::vector<float>& values, const Tiles& tiles, const Better& better) const {
    const int width = tiles.right - tiles.left + 1, height = tiles.bottom - tiles.top + 1;
    const int level_x = levelOf(width), level_y = levelOf(height), side_x = 1 << level_x, side_y = 1 << level_y;
    const int table = level_y * kLevels + level_x;
    const float* first = values.data() + static_cast<std::ptrdiff_t>(table * rows_ + tiles.top) * columns_ + tiles.left;
    const int right = width - side_x, down = (height - side_y) * columns_;
    float best = better(better(first[0], first[right]), better(first[down], first[down + right]));
    if (right <= side_x && height <= 2 * side_y) return best;
    for (int y = 0; y <= down; y = y < down ? std::min(y + side_y * columns_, down) : down + 1) {
      for (int x = 0; x <= right; x = x < right ? std::min(x + side_x, right) : right + 1)
        best = better(best, first[y + x]);
    }
    return best;
  }

  int columns_ = 0, rows_ = 0;
  std::vector<float> nearest_m_;  // [level_y][level_x][row][column]: over 2^level_x x 2^level_y tiles from there on
  std::array<std::vector<float>, kWindows> farthest_m_;  // likewise, of the least of each square of a size
  std::vector<int> rays_;                                // per tile
  std::vector<int> unusable_sum_;                        // [row][column]: tiles above and left that hold too few rays
  std::vector<float> column_near_m_;                     // scratch, per pixel column of a row of tiles
  std::vector<int> column_rays_;
};

}  // namespace flight_corridor
