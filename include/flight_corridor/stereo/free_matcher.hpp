#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace flight_corridor {

/// A corner, and where another image shows it.
struct FreeMatch {
  cv::Point2f from_px, to_px;  ///< In images of full size.
};

/// Finds corners of one image in another without the epipolar constraint: by a search over columns and rows at a
/// quarter of the size, refined by Lucas-Kanade (Bouguet 2001) and checked back. One object, one thread.
class FreeMatcher {
 public:
  /// @param from, to CV_8UC1 of one size.
  /// @return up to a hundred matches, spread over the image; none where the texture allows several rows. Valid until
  /// the next call.
  const std::vector<FreeMatch>& match(const cv::Mat& from, const cv::Mat& to);

 private:
  /// An image without its light: each pixel relative to mean and deviation around it.
  struct Levels {
    cv::Mat fine, coarse, black;
    int coarse_px = 1;  // edge of a coarse pixel in fine ones
    void make(const cv::Mat& image, int square_px);
  };

  void findCorners();
  void refine(float square_px);

  Levels from_, to_;
  cv::Mat cornerness_;
  std::vector<cv::Point2f> corners_, found_, back_;
  std::vector<unsigned char> is_found_, is_back_;
  std::vector<float> errors_;
  std::vector<FreeMatch> matches_;
};

}  // namespace flight_corridor
