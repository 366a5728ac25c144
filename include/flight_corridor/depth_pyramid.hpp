#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace flight_corridor {

/// How far the rays of an image rectangle reach, in constant time: a sparse table of minima and maxima (Bender and
/// Farach-Colton 2000) over tiles of kTile_px x kTile_px pixels. Rectangles are widened to whole tiles, so that an
/// answer never leaves out a ray that was asked for.
class DepthPyramid {
 public:
  static constexpr int kTile_px = 4;

  /// What the rays of a rectangle say.
  struct Reach {
    float nearest_m;      ///< Smallest of the near depths; +inf when there is no ray.
    float farthest_m;     ///< Largest of the far depths; 0 when there is no ray.
    float tile_fraction;  ///< Share of the rectangle's tiles that hold rays enough [0..1].
  };

  /// @param near_m, far_m  CV_32FC1 of one size: depth up to which a pixel's ray is surely free, and where it may end
  /// at most; NaN in both = no ray.
  /// @param min_ray_fraction share of a tile's pixels that must have a ray.
  void build(const cv::Mat& near_m, const cv::Mat& far_m, double min_ray_fraction);

  /// @param rectangle in pixels, not empty, inside the image.
  Reach reach(const cv::Rect& rectangle) const;

 private:
  void buildTiles(const cv::Mat& near_m, const cv::Mat& far_m, double min_ray_fraction);
  std::size_t level(int log_columns, int log_rows) const;

  int columns_ = 0, rows_ = 0;          // of tiles
  int log_columns_ = 0, log_rows_ = 0;  // levels of the table
  std::vector<float> nearest_,
      farthest_;  // [log_rows][log_columns][row][column]: over 2^log_rows x 2^log_columns tiles
  std::vector<std::uint8_t> usable_;
  cv::Mat usable_sum_;     // CV_32SC1 integral image of usable_
  std::vector<int> rays_;  // scratch: rays per tile of one row of tiles
};

}  // namespace flight_corridor
