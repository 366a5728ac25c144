#pragma once

#include <opencv2/core/mat.hpp>

#include "flight_corridor/corridor.hpp"
#include "flight_corridor/disparity_estimator.hpp"
#include "flight_corridor/stereo_geometry.hpp"

namespace flight_corridor {

/// Texture of the left image that fits nowhere in the right one although nothing known hides it there: what a thing
/// leaves behind that was matched wrongly, or not at all. Of two parallel wires each fits on the other: they are found
/// far away, and betrayed by the background that they hide from one camera. Nets and fences do the same.
class UnmatchedTexture {
 public:
  explicit UnmatchedTexture(const StereoGeometry& geometry) : geometry_(geometry) {}

  /// @param depth_m CV_32FC1, NaN = nothing, of the same pair as the disparity.
  void find(const Disparity& disparity, const cv::Mat& depth_m);

  /// Share of the texture that is unmatched [0..1]: the largest of a box's cross-sections, as the image shows them; 0
  /// before the first pair.
  /// @param box_C the box in C.
  double share(const Box& box_C) const;

 private:
  void addRow(const float* depth_m, const float* texture, int cols, float least, float* unmatched) const;
  bool isHidden(int width_px, float before_m, float after_m) const;
  cv::Rect view(const Box& box_C, double x_m) const;

  StereoGeometry geometry_;
  double least_texture_ = 0.0;
  cv::Mat unmatched_;                    // texture, 0 where it is matched or weak
  cv::Mat texture_sum_, unmatched_sum_;  // integral images
};

}  // namespace flight_corridor
