#pragma once

#include <opencv2/imgproc.hpp>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor::test_support {

/// Depth image of a wall square to the optical axis.
inline cv::Mat wallDepth(cv::Size size, double depth_m) { return cv::Mat(size, CV_32FC1, cv::Scalar(depth_m)); }

/// A stereo pair of a noise-textured wall square to the optical axis: every pixel has the same whole disparity
/// (principal-point difference not included). Another stamp shows another wall: no two images of a camera are equal.
inline StereoFrame wallFrame(const StereoGeometry& geometry, int disparity_px, double stamp_s) {
  const int difference_px = static_cast<int>(geometry.principalPointDifference());
  const int shift_px = disparity_px + difference_px;
  const int wide = geometry.size().width + shift_px;
  cv::Mat texture(geometry.size().height, wide, CV_8UC1);
  cv::RNG random(12345 + static_cast<std::uint64_t>(1000.0 * stamp_s));
  random.fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, {3, 3}, 0.8);
  StereoFrame frame;
  frame.stamp_s = stamp_s;
  // A point at column u of the left image stands at u - shift of the right one.
  frame.left = texture.colRange(0, geometry.size().width).clone();
  frame.right = texture.colRange(shift_px, wide).clone();
  return frame;
}

}  // namespace flight_corridor::test_support
