#include "flight_corridor/depth_pyramid.hpp"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace flight_corridor {

void DepthPyramid::build(const cv::Mat& depth_m, const StereoGeometry& geometry, double free_band_px,
                         double min_ray_fraction) {
  columns_ = (depth_m.cols + kTile_px - 1) / kTile_px;
  rows_ = (depth_m.rows + kTile_px - 1) / kTile_px;
  level_of_.assign(std::min(columns_, rows_) + 1, 0);
  for (std::size_t side = 2; side < level_of_.size(); ++side) level_of_[side] = level_of_[side / 2] + 1;
  levels_ = level_of_.back() + 1;
  const std::size_t tiles = static_cast<std::size_t>(columns_) * rows_;
  nearest_m_.resize(tiles * levels_);
  farthest_m_.resize(tiles * levels_);
  usable_.resize(tiles);

  buildTiles(depth_m, min_ray_fraction);
  // The band keeps the order of depths: it is enough to shift each tile's nearest.
  for (std::size_t i = 0; i < tiles; ++i) {
    if (farthest_m_[i] > 0.0f) nearest_m_[i] = farthest_m_[i] = geometry.shiftedDepth(nearest_m_[i], free_band_px);
  }
  for (int level = 1; level < levels_; ++level) joinSquares(level);
  cv::integral(cv::Mat(rows_, columns_, CV_8UC1, usable_.data()), usable_sum_, CV_32S);
}

void DepthPyramid::buildTiles(const cv::Mat& depth_m, double min_ray_fraction) {
  for (int first_row = 0; first_row < depth_m.rows; first_row += kTile_px) {
    column_near_m_.assign(depth_m.cols, std::numeric_limits<float>::infinity());
    column_rays_.assign(depth_m.cols, 0);
    const int height_px = std::min(kTile_px, depth_m.rows - first_row);
    for (int v = first_row; v < first_row + height_px; ++v) addRow(depth_m.ptr<float>(v));
    endTileRow(first_row / kTile_px, height_px, depth_m.cols, min_ray_fraction);
  }
}

void DepthPyramid::addRow(const float* depth_m) {
  const int width = static_cast<int>(column_near_m_.size());
  float* near_m = column_near_m_.data();
  int* rays = column_rays_.data();
  for (int u = 0; u < width; ++u) near_m[u] = depth_m[u] < near_m[u] ? depth_m[u] : near_m[u];  // NaN changes nothing
  for (int u = 0; u < width; ++u) rays[u] += depth_m[u] == depth_m[u];
}

void DepthPyramid::endTileRow(int tile_row, int height_px, int width_px, double min_ray_fraction) {
  for (int column = 0; column < columns_; ++column) {
    const int first = column * kTile_px, last = std::min(first + kTile_px, width_px);
    const std::size_t tile = static_cast<std::size_t>(tile_row) * columns_ + column;
    const float nearest_m = *std::min_element(&column_near_m_[first], &column_near_m_[0] + last);
    int rays = 0;
    for (int u = first; u < last; ++u) rays += column_rays_[u];
    nearest_m_[tile] = nearest_m;
    farthest_m_[tile] = rays > 0 ? nearest_m : 0.0f;
    usable_[tile] = rays >= min_ray_fraction * (last - first) * height_px;
  }
}

/// Squares of one level from four of the level below.
void DepthPyramid::joinSquares(int level) {
  const std::size_t tiles = static_cast<std::size_t>(columns_) * rows_;
  const int step = 1 << (level - 1), width = columns_ - 2 * step + 1;
  for (int row = 0; row + 2 * step <= rows_; ++row) {
    const std::size_t joined = level * tiles + static_cast<std::size_t>(row) * columns_;
    const std::size_t above = joined - tiles, below = above + static_cast<std::size_t>(step) * columns_;
    const float *near_above_m = &nearest_m_[above], *near_below_m = &nearest_m_[below];
    const float *far_above_m = &farthest_m_[above], *far_below_m = &farthest_m_[below];
    float *near_m = &nearest_m_[joined], *far_m = &farthest_m_[joined];
    for (int i = 0; i < width; ++i) {
      near_m[i] = std::min(std::min(near_above_m[i], near_above_m[i + step]),
                           std::min(near_below_m[i], near_below_m[i + step]));
      far_m[i] =
          std::max(std::max(far_above_m[i], far_above_m[i + step]), std::max(far_below_m[i], far_below_m[i + step]));
    }
  }
}

double DepthPyramid::usableFraction(const Tiles& tiles) const {
  const auto* above = usable_sum_.ptr<int>(tiles.top);
  const auto* below = usable_sum_.ptr<int>(tiles.bottom + 1);
  const int usable = below[tiles.right + 1] - above[tiles.right + 1] - below[tiles.left] + above[tiles.left];
  return usable / static_cast<double>((tiles.right - tiles.left + 1) * (tiles.bottom - tiles.top + 1));
}

}  // namespace flight_corridor
