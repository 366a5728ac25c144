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

std::size_t DepthPyramid::level(int log_columns, int log_rows) const {
  return (static_cast<std::size_t>(log_rows) * (log_columns_ + 1) + log_columns) * columns_ * rows_;
}

void DepthPyramid::build(const cv::Mat& near_m, const cv::Mat& far_m, double min_ray_fraction) {
  buildTiles(near_m, far_m, min_ray_fraction);
  const auto join = [&](std::size_t from, std::size_t to, int step_columns, int step_rows) {
    for (int row = 0; row + step_rows < rows_; ++row) {
      const std::size_t a = static_cast<std::size_t>(row) * columns_;
      const std::size_t b = a + static_cast<std::size_t>(step_rows) * columns_ + step_columns;
      for (int column = 0; column + step_columns < columns_; ++column) {
        nearest_[to + a + column] = std::min(nearest_[from + a + column], nearest_[from + b + column]);
        farthest_[to + a + column] = std::max(farthest_[from + a + column], farthest_[from + b + column]);
      }
    }
  };
  for (int log_row = 0; log_row <= log_rows_; ++log_row) {
    if (log_row > 0) join(level(0, log_row - 1), level(0, log_row), 0, 1 << (log_row - 1));
    for (int log_column = 1; log_column <= log_columns_; ++log_column) {
      join(level(log_column - 1, log_row), level(log_column, log_row), 1 << (log_column - 1), 0);
    }
  }
  cv::integral(cv::Mat(rows_, columns_, CV_8UC1, usable_.data()), usable_sum_, CV_32S);
}

void DepthPyramid::buildTiles(const cv::Mat& near_m, const cv::Mat& far_m, double min_ray_fraction) {
  columns_ = (near_m.cols + kTile_px - 1) / kTile_px;
  rows_ = (near_m.rows + kTile_px - 1) / kTile_px;
  log_columns_ = floorLog2(columns_);
  log_rows_ = floorLog2(rows_);
  const std::size_t tiles = static_cast<std::size_t>(columns_) * rows_;
  const std::size_t levels = static_cast<std::size_t>(log_columns_ + 1) * (log_rows_ + 1);
  nearest_.resize(tiles * levels);
  farthest_.resize(tiles * levels);
  usable_.resize(tiles);
  std::fill_n(nearest_.begin(), tiles, std::numeric_limits<float>::infinity());
  std::fill_n(farthest_.begin(), tiles, 0.0f);
  rays_.assign(columns_, 0);

  for (int v = 0; v < near_m.rows; ++v) {
    const auto* near_row = near_m.ptr<float>(v);
    const auto* far_row = far_m.ptr<float>(v);
    const std::size_t tile_row = static_cast<std::size_t>(v / kTile_px) * columns_;
    for (int u = 0; u < near_m.cols; ++u) {
      const int column = u / kTile_px;
      // Written so that NaN changes nothing.
      if (near_row[u] < nearest_[tile_row + column]) nearest_[tile_row + column] = near_row[u];
      if (far_row[u] > farthest_[tile_row + column]) farthest_[tile_row + column] = far_row[u];
      rays_[column] += near_row[u] == near_row[u];
    }
    const bool tile_ends = (v + 1) % kTile_px == 0 || v + 1 == near_m.rows;
    if (!tile_ends) continue;
    const int height = v % kTile_px + 1;
    for (int column = 0; column < columns_; ++column) {
      const int width = std::min(kTile_px, near_m.cols - column * kTile_px);
      usable_[tile_row + column] = rays_[column] >= min_ray_fraction * width * height;
      rays_[column] = 0;
    }
  }
}

DepthPyramid::Reach DepthPyramid::reach(const cv::Rect& rectangle) const {
  const int left = rectangle.x / kTile_px, right = (rectangle.x + rectangle.width - 1) / kTile_px;
  const int top = rectangle.y / kTile_px, bottom = (rectangle.y + rectangle.height - 1) / kTile_px;
  const int log_column = floorLog2(right - left + 1), log_row = floorLog2(bottom - top + 1);
  const int second_column = right + 1 - (1 << log_column), second_row = bottom + 1 - (1 << log_row);
  const std::size_t base = level(log_column, log_row);
  const std::size_t corners[] = {base + static_cast<std::size_t>(top) * columns_ + left,
                                 base + static_cast<std::size_t>(top) * columns_ + second_column,
                                 base + static_cast<std::size_t>(second_row) * columns_ + left,
                                 base + static_cast<std::size_t>(second_row) * columns_ + second_column};
  Reach reach{nearest_[corners[0]], farthest_[corners[0]], 0.0f};
  for (int i = 1; i < 4; ++i) {
    reach.nearest_m = std::min(reach.nearest_m, nearest_[corners[i]]);
    reach.farthest_m = std::max(reach.farthest_m, farthest_[corners[i]]);
  }
  const auto sum = [&](int row, int column) { return usable_sum_.at<int>(row, column); };
  const int usable = sum(bottom + 1, right + 1) - sum(top, right + 1) - sum(bottom + 1, left) + sum(top, left);
  reach.tile_fraction = static_cast<float>(usable) / ((right - left + 1) * (bottom - top + 1));
  return reach;
}

}  // namespace flight_corridor
