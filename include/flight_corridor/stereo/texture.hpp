#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace flight_corridor {

/// The texture of an image along its rows. A match elsewhere is chance: noise agrees, or paths spread a neighbour's
/// disparity. The criterion is the variance of the difference of pixels four columns apart over a window, against that
/// of the image's own noise; a ramp of light has no variance. One object, one thread.
class Texture {
 public:
  /// @param grey CV_8UC1.  @param covered CV_8UC1, see coveredPixels(): texture without matches, so that a run without
  /// texture ends there, at no known surface; empty: nothing is covered.
  /// @return CV_8UC1, 255 where there is texture; valid until the next call.
  const cv::Mat& find(const cv::Mat& grey, const cv::Mat& covered = cv::Mat());

  /// Of the last image.
  const cv::Mat& mask() const { return textured_; }
  /// CV_8UC1, 255 where the last image is clipped, black or white, and so has no texture whatever is there.
  const cv::Mat& clipped() const { return clipped_; }

  /// One sigma of a pixel's noise in the last image [grey levels]; in a scene without smooth regions it includes
  /// texture.
  double noise() const { return noise_; }

 private:
  void findRow(const cv::Mat& grey, int v, int enough);

  double noise_ = 0.0;
  cv::Mat textured_, clipped_;
  std::vector<float> spreads_;               // of blocks
  std::vector<std::int32_t> sum_, squares_;  // of differences, a column of the window
};

}  // namespace flight_corridor
