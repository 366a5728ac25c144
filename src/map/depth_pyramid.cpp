#include "flight_corridor/map/depth_pyramid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "flight_corridor/map/wide_registers.hpp"

namespace flight_corridor {

void DepthPyramid::build(const cv::Mat& depth_m, const StereoGeometry& geometry, double free_band_px,
                         double min_tile_fraction) {
  columns_ = (depth_m.cols + kTile_px - 1) / kTile_px;
  rows_ = (depth_m.rows + kTile_px - 1) / kTile_px;
  const std::size_t tiles = static_cast<std::size_t>(columns_) * rows_;
  nearest_m_.resize(tiles * kLevels * kLevels);
  rays_.resize(tiles);
  unusable_sum_.assign(static_cast<std::size_t>(columns_ + 1) * (rows_ + 1), 0);
  buildTiles(depth_m, min_tile_fraction);
  // The band keeps the order of depths: it is enough to shift each tile's nearest. Tiles without a ray stay at
  // infinity.
  for (std::size_t i = 0; i < tiles; ++i) {
    if (rays_[i] > 0) nearest_m_[i] = geometry.shiftedDepth(nearest_m_[i], free_band_px);
  }
  joinBlocks(nearest_m_, [](float a, float b) { return std::min(a, b); });
  for (int window = 0; window < kWindows; ++window) buildFarthest(window);
}

/// Squares without a ray bound nothing: another one within the rectangle that is asked about does.
void DepthPyramid::buildFarthest(int window) {
  const std::size_t tiles = static_cast<std::size_t>(columns_) * rows_;
  std::vector<float>& farthest_m = farthest_m_[window];
  farthest_m.resize(tiles * kLevels * kLevels);
  const float* least_m = &nearest_m_[tiles * window * (kLevels + 1)];
  for (std::size_t i = 0; i < tiles; ++i) farthest_m[i] = least_m[i] < INFINITY ? least_m[i] : 0.0f;
  joinBlocks(farthest_m, [](float a, float b) { return std::max(a, b); });
}

void DepthPyramid::buildTiles(const cv::Mat& depth_m, double min_tile_fraction) {
  for (int first_row = 0; first_row < depth_m.rows; first_row += kTile_px) {
    column_near_m_.assign(depth_m.cols, std::numeric_limits<float>::infinity());
    column_rays_.assign(depth_m.cols, 0);
    const int height_px = std::min(kTile_px, depth_m.rows - first_row);
    for (int v = first_row; v < first_row + height_px; ++v) addRow(depth_m.ptr<float>(v));
    endTileRow(first_row / kTile_px, height_px, depth_m.cols, min_tile_fraction);
  }
}

void DepthPyramid::addRow(const float* depth_m) {
  const int width = static_cast<int>(column_near_m_.size());
  float* near_m = column_near_m_.data();
  int* rays = column_rays_.data();
  for (int u = 0; u < width; ++u) near_m[u] = depth_m[u] < near_m[u] ? depth_m[u] : near_m[u];  // NaN changes nothing
  for (int u = 0; u < width; ++u) rays[u] += depth_m[u] == depth_m[u];
}

void DepthPyramid::endTileRow(int tile_row, int height_px, int width_px, double min_tile_fraction) {
  int in_row = 0;
  for (int column = 0; column < columns_; ++column) {
    const int first = column * kTile_px, last = std::min(first + kTile_px, width_px);
    const std::size_t tile = static_cast<std::size_t>(tile_row) * columns_ + column;
    nearest_m_[tile] = *std::min_element(&column_near_m_[first], &column_near_m_[0] + last);
    int rays = 0;
    for (int u = first; u < last; ++u) rays += column_rays_[u];
    rays_[tile] = rays;
    const bool is_usable = rays >= min_tile_fraction * (last - first) * height_px;
    const std::size_t corner = static_cast<std::size_t>(tile_row + 1) * (columns_ + 1) + column + 1;
    in_row += !is_usable;
    unusable_sum_[corner] = unusable_sum_[corner - columns_ - 1] + in_row;
  }
}

/// Each block from its two halves. Where blocks leave the image, they hold what nobody asks for.
template <class Better>
void DepthPyramid::joinBlocks(std::vector<float>& values, const Better& better) {
  const std::ptrdiff_t tiles = static_cast<std::ptrdiff_t>(columns_) * rows_;
  for (int level = 1; level < kLevels * kLevels; ++level) {
    const int x = level % kLevels, y = level / kLevels;
    const float* halves = &values[(x > 0 ? level - 1 : level - kLevels) * tiles];
    const std::ptrdiff_t step = x > 0 ? 1 << (x - 1) : std::ptrdiff_t{columns_} << (y - 1);
    float* blocks = &values[level * tiles];
    for (std::ptrdiff_t i = 0; i + step < tiles; ++i) blocks[i] = better(halves[i], halves[i + step]);
  }
}

FLIGHT_CORRIDOR_WIDE void DepthPyramid::nearest(const EightTiles& tiles, float (&nearest_m)[8]) const {
  static_assert(kLevels == 3, "levels of 1, 2 and 4 tiles are distinguished here");
  const int columns = columns_, rows = rows_;
  const float* values_m = nearest_m_.data();
  int first[8], right[8], down[8], is_large[8];
  for (int i = 0; i < 8; ++i) {
    const int width = tiles.right[i] - tiles.left[i] + 1, height = tiles.bottom[i] - tiles.top[i] + 1;
    const int level_x = (width >= 2) + (width >= 4), level_y = (height >= 2) + (height >= 4);
    right[i] = width - (1 << level_x);
    down[i] = (height - (1 << level_y)) * columns;
    first[i] = ((level_y * kLevels + level_x) * rows + tiles.top[i]) * columns + tiles.left[i];
    is_large[i] = (width > 8) | (height > 8);
  }
  int some_large = 0;
  for (int i = 0; i < 8; ++i) some_large |= is_large[i];
  if (some_large != 0) {
    for (unsigned i = 0; i < 8; ++i) nearest_m[i] = nearest(tiles[i]);
    return;
  }
  float above_m[8], below_m[8];
  for (int i = 0; i < 8; ++i) above_m[i] = std::min(values_m[first[i]], values_m[first[i] + right[i]]);
  for (int i = 0; i < 8; ++i) first[i] += down[i];
  for (int i = 0; i < 8; ++i) below_m[i] = std::min(values_m[first[i]], values_m[first[i] + right[i]]);
  for (int i = 0; i < 8; ++i) nearest_m[i] = std::min(above_m[i], below_m[i]);
}

FLIGHT_CORRIDOR_WIDE void DepthPyramid::unusable(const EightTiles& tiles, int (&unusable)[8]) const {
  const int stride = columns_ + 1;
  const int* sum = unusable_sum_.data();
  for (int i = 0; i < 8; ++i) {
    const int above = tiles.top[i] * stride, below = (tiles.bottom[i] + 1) * stride;
    const int left = tiles.left[i], right = tiles.right[i] + 1;
    unusable[i] = sum[below + right] - sum[above + right] - sum[below + left] + sum[above + left];
  }
}

}  // namespace flight_corridor
