#include "flight_corridor/map/depth_pyramid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace flight_corridor {

void DepthPyramid::build(const cv::Mat& depth_m, const StereoGeometry& geometry, double free_band_px,
                         double min_tile_fraction) {
  const int columns = (depth_m.cols + kTile_px - 1) / kTile_px, rows = (depth_m.rows + kTile_px - 1) / kTile_px;
  nearest_m_.assign(1, cv::Mat1f(rows, columns));
  minus_farthest_m_.assign(1, cv::Mat1f(rows, columns));
  cv::Mat1b is_unusable(rows, columns);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const cv::Rect pixels =
          cv::Rect(column * kTile_px, row * kTile_px, kTile_px, kTile_px) & cv::Rect({0, 0}, depth_m.size());
      float nearest_m = std::numeric_limits<float>::infinity();
      int rays = 0;
      for (int v = pixels.y; v < pixels.br().y; ++v) {
        const float* surface_m = depth_m.ptr<float>(v);
        for (int u = pixels.x; u < pixels.br().x; ++u) {
          rays += !std::isnan(surface_m[u]);
          nearest_m = surface_m[u] < nearest_m ? surface_m[u] : nearest_m;
        }
      }
      // The band keeps the order of depths: it is enough to shift each tile's nearest.
      if (rays > 0) nearest_m = geometry.shiftedDepth(nearest_m, free_band_px);
      nearest_m_[0](row, column) = nearest_m;
      minus_farthest_m_[0](row, column) = rays > 0 ? -nearest_m : 0.0f;
      is_unusable(row, column) = rays < min_tile_fraction * pixels.area();
    }
  }
  joinSquares(nearest_m_);
  joinSquares(minus_farthest_m_);
  cv::integral(is_unusable, unusable_sum_, CV_32S);
}

/// Each square from four of half its side.
void DepthPyramid::joinSquares(Squares& squares) const {
  for (int half = 1; 2 * half <= std::min(squares[0].rows, squares[0].cols); half *= 2) {
    const cv::Mat& halves = squares.back();
    const int width = halves.cols - half, height = halves.rows - half;
    cv::Mat beside, joined;
    cv::min(halves.colRange(0, width), halves.colRange(half, halves.cols), beside);
    cv::min(beside.rowRange(0, height), beside.rowRange(half, beside.rows), joined);
    squares.push_back(joined);
  }
}

/// Over the largest squares that fit in the rectangle, as many as cover it.
float DepthPyramid::least(const Squares& squares, const cv::Rect& tiles) {
  const int last_level = static_cast<int>(squares.size()) - 1;
  int level = 0;
  while (level < last_level && 2 << level <= std::min(tiles.width, tiles.height)) ++level;
  const int side = 1 << level, last_x = tiles.width - side, last_y = tiles.height - side;
  float least = std::numeric_limits<float>::infinity();
  for (int y = 0; y < last_y + side; y += side) {
    const float* row = squares[static_cast<std::size_t>(level)][tiles.y + std::min(y, last_y)] + tiles.x;
    for (int x = 0; x < last_x + side; x += side) least = std::min(least, row[std::min(x, last_x)]);
  }
  return least;
}

int DepthPyramid::unusable(const cv::Rect& tiles) const {
  const int *above = unusable_sum_[tiles.y], *below = unusable_sum_[tiles.y + tiles.height];
  const int left = tiles.x, right = tiles.x + tiles.width;
  return below[right] - above[right] - below[left] + above[left];
}

}  // namespace flight_corridor
