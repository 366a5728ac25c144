#include "flight_corridor/depth_pyramid.hpp"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace flight_corridor {

namespace {

int floorLog2(int value) {
  int log = 0;
  while (value >>= 1) ++log;
  return log;
}

}  // namespace

void DepthPyramid::build(const cv::Mat& depth_m, const StereoGeometry& geometry, double free_band_px,
                         double min_ray_fraction) {
  columns_ = (depth_m.cols + kTile_px - 1) / kTile_px;
  rows_ = (depth_m.rows + kTile_px - 1) / kTile_px;
  levels_ = floorLog2(std::min(columns_, rows_)) + 1;
  const std::size_t tiles = static_cast<std::size_t>(columns_) * rows_;
  squares_.resize(tiles * levels_);
  usable_.resize(tiles);

  buildTiles(depth_m, min_ray_fraction);
  // The band keeps the order of depths: it is enough to shift each tile's nearest.
  for (std::size_t i = 0; i < tiles; ++i) {
    Square& tile = squares_[i];
    if (tile.minus_farthest_m < 0.0f) {
      tile.nearest_m = geometry.shiftedDepth(tile.nearest_m, free_band_px);
      tile.minus_farthest_m = -tile.nearest_m;
    }
  }
  for (int level = 1; level < levels_; ++level) joinSquares(level);
  cv::integral(cv::Mat(rows_, columns_, CV_8UC1, usable_.data()), usable_sum_, CV_32S);
}

void DepthPyramid::buildTiles(const cv::Mat& depth_m, double min_ray_fraction) {
  for (int first_row = 0; first_row < depth_m.rows; first_row += kTile_px) {
    column_near_m_.assign(depth_m.cols, std::numeric_limits<float>::infinity());
    column_rays_.assign(depth_m.cols, 0);
    const int height_px = std::min(kTile_px, depth_m.rows - first_row);
    for (int v = first_row; v < first_row + height_px; ++v) {
      const auto* row = depth_m.ptr<float>(v);
      for (int u = 0; u < depth_m.cols; ++u) {  // NaN changes nothing
        column_near_m_[u] = row[u] < column_near_m_[u] ? row[u] : column_near_m_[u];
        column_rays_[u] += row[u] == row[u];
      }
    }
    endTileRow(first_row / kTile_px, height_px, depth_m.cols, min_ray_fraction);
  }
}

void DepthPyramid::endTileRow(int tile_row, int height_px, int width_px, double min_ray_fraction) {
  for (int column = 0; column < columns_; ++column) {
    const int first = column * kTile_px, last = std::min(first + kTile_px, width_px);
    const std::size_t tile = static_cast<std::size_t>(tile_row) * columns_ + column;
    const float nearest_m = *std::min_element(&column_near_m_[first], &column_near_m_[0] + last);
    int rays = 0;
    for (int u = first; u < last; ++u) rays += column_rays_[u];
    squares_[tile] = {nearest_m, rays > 0 ? -nearest_m : 0.0f};
    usable_[tile] = rays >= min_ray_fraction * (last - first) * height_px;
  }
}

/// Squares of one level from four of the level below.
void DepthPyramid::joinSquares(int level) {
  const std::size_t tiles = static_cast<std::size_t>(columns_) * rows_;
  const int step = 1 << (level - 1);
  for (int row = 0; row + 2 * step <= rows_; ++row) {
    const std::size_t at = static_cast<std::size_t>(row) * columns_;
    const Square* above = &squares_[(level - 1) * tiles + at];
    const Square* below = above + static_cast<std::size_t>(step) * columns_;
    Square* joined = &squares_[level * tiles + at];
    for (int i = 0; i + 2 * step <= columns_; ++i) {
      joined[i] = least(least(above[i], above[i + step]), least(below[i], below[i + step]));
    }
  }
}

DepthPyramid::Reach DepthPyramid::reach(const Tiles& tiles) const {
  const int level = floorLog2(std::min(tiles.right - tiles.left, tiles.bottom - tiles.top) + 1), side = 1 << level;
  const Square* base = &squares_[static_cast<std::size_t>(level) * columns_ * rows_];
  Square all{std::numeric_limits<float>::infinity(), 0.0f};
  // Squares side by side, the last ones moved back to end with the rectangle.
  for (int row = tiles.top; row <= tiles.bottom; row += side) {
    const Square* line = base + static_cast<std::size_t>(std::min(row, tiles.bottom + 1 - side)) * columns_;
    for (int column = tiles.left; column <= tiles.right; column += side) {
      all = least(all, line[std::min(column, tiles.right + 1 - side)]);
    }
  }
  return {all.nearest_m, -all.minus_farthest_m};
}

double DepthPyramid::usableFraction(const Tiles& tiles) const {
  const auto* above = usable_sum_.ptr<int>(tiles.top);
  const auto* below = usable_sum_.ptr<int>(tiles.bottom + 1);
  const int usable = below[tiles.right + 1] - above[tiles.right + 1] - below[tiles.left] + above[tiles.left];
  return usable / static_cast<double>((tiles.right - tiles.left + 1) * (tiles.bottom - tiles.top + 1));
}

}  // namespace flight_corridor
