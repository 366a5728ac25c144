#include "flight_corridor/stereo/free_matcher.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <optional>

namespace flight_corridor {

namespace {

constexpr int kFineWidth_px = 640, kCoarseWidth_px = 200;  // below these
constexpr int kLight_px = 11;                              // window of mean and deviation
constexpr double kFlat_grey = 4.0;                         // deviation of noise
constexpr double kContrast = 40.0;                         // levels per deviation
constexpr int kAcross = 14, kDown = 10;                    // cells, each with its best corner
constexpr float kLeastCornerness = 1e-3f;                  // smallest eigenvalue of the gradients' covariance
constexpr int kPatchReach_px = 4;                          // reach of a coarse patch
constexpr double kColumnsLeft = 0.2, kColumnsRight = 0.05, kRows = 0.04;  // of the width: the search
constexpr int kOtherRow_px = 2;                                           // coarse
constexpr double kUnique = 1.2, kNoise_levels = 1.0;  // difference of a match in other rows, at least
constexpr int kMostDifference = 30;                   // levels, mean
constexpr int kFlow_px = 13;                          // of Lucas-Kanade
constexpr float kBack_px = 0.3f;                      // fine

/// Edge of the squares of pixels that become one, so that an image is narrow enough.
int squareOf(const cv::Mat& image, int widest_px) {
  int square_px = 1;
  while (image.cols / square_px >= widest_px) square_px *= 2;
  return square_px;
}

cv::Mat shrunk(const cv::Mat& image, int square_px) {
  if (square_px == 1) return image;
  cv::Mat smaller;
  const cv::Size size(image.cols / square_px, image.rows / square_px);
  cv::resize(image({{0, 0}, size * square_px}), smaller, size, 0.0, 0.0, cv::INTER_AREA);
  return smaller;
}

/// Sum of differences of two patches; once it is above most, any larger sum.
int difference(const cv::Mat& a, cv::Point at_a, const cv::Mat& b, cv::Point at_b, int most) {
  int sum = 0;
  for (int v = -kPatchReach_px; v < kPatchReach_px && sum <= most; ++v) {
    const unsigned char* row_a = a.ptr(at_a.y + v) + at_a.x - kPatchReach_px;
    const unsigned char* row_b = b.ptr(at_b.y + v) + at_b.x - kPatchReach_px;
    for (int u = 0; u < 2 * kPatchReach_px; ++u) sum += std::abs(row_a[u] - row_b[u]);
  }
  return sum;
}

/// What patches in other rows must differ by, so that one that differs by so much is the only one.
int leastOfOthers(int best) {
  return static_cast<int>(kUnique * best + kNoise_levels * 4 * kPatchReach_px * kPatchReach_px);
}

/// The rows of a search, the likely ones first.
int rowOf(int i) { return i % 2 == 0 ? i / 2 : -(i + 1) / 2; }

/// The place in the other image, if no other row shows a similar one.
std::optional<cv::Point> search(const cv::Mat& from, cv::Point at, const cv::Mat& to) {
  constexpr int kSide = 2 * kPatchReach_px, kMost = kMostDifference * kSide * kSide, kMostRows = 63;
  const cv::Rect inner(kPatchReach_px, kPatchReach_px, to.cols - kSide + 1, to.rows - kSide + 1);
  if (!inner.contains(at)) return std::nullopt;
  const int first_u = std::max(at.x - static_cast<int>(kColumnsLeft * to.cols), inner.x);
  const int end_u = std::min(at.x + static_cast<int>(kColumnsRight * to.cols) + 1, inner.br().x);
  const int rows = std::min(2 * static_cast<int>(std::lround(kRows * to.cols)) + 1, kMostRows);
  std::array<int, kMostRows> least;
  least.fill(std::numeric_limits<int>::max());
  int best = kMost, best_row = 0, best_u = -1;
  for (int i = 0; i < rows; ++i) {
    const int v = at.y + rowOf(i);
    for (int u = first_u; u < end_u && inner.y <= v && v < inner.br().y; ++u) {
      const int most = std::min(least[i], leastOfOthers(best));  // what is above need not be known
      const int sum = difference(from, at, to, {u, v}, most);
      if (sum < most) least[i] = sum;
      if (sum < best) best = sum, best_row = rowOf(i), best_u = u;
    }
  }
  for (int i = 0; i < rows; ++i) {
    if (std::abs(rowOf(i) - best_row) >= kOtherRow_px && least[i] < leastOfOthers(best)) return std::nullopt;
  }
  return best_u < 0 ? std::nullopt : std::optional(cv::Point(best_u, at.y + best_row));
}

/// Each pixel less the mean around it, in units of the deviation there.
cv::Mat withoutLight(const cv::Mat& grey) {
  cv::Mat values, mean, squares, levels;
  grey.convertTo(values, CV_32F);
  const cv::Size window(kLight_px, kLight_px);
  cv::blur(values, mean, window);
  cv::blur(values.mul(values), squares, window);
  cv::Mat deviation = cv::max(squares - mean.mul(mean), 0.0);
  cv::sqrt(deviation, deviation);
  cv::Mat relative = (values - mean) / (deviation + kFlat_grey);
  relative.convertTo(levels, CV_8U, kContrast, 128.0);
  return levels;
}

}  // namespace

void FreeMatcher::Levels::make(const cv::Mat& image, int square_px) {
  const cv::Mat grey = shrunk(image, square_px);
  coarse_px = squareOf(grey, kCoarseWidth_px);
  cv::Mat smooth;
  cv::blur(shrunk(grey, coarse_px), smooth, {3, 3});  // a match may lie between its pixels
  fine = withoutLight(grey);
  coarse = withoutLight(smooth);
  black = grey == 0;
}

/// The best one of each cell; none where the image is black, beyond the border of a rectified image.
void FreeMatcher::findCorners() {
  corners_.clear();
  cv::cornerMinEigenVal(from_.fine, cornerness_, 5);
  const int margin = kFlow_px / 2 + 1;
  const cv::Rect inner(margin, margin, from_.fine.cols - 2 * margin, from_.fine.rows - 2 * margin);
  for (int row = 0; row < kDown && !inner.empty(); ++row) {
    for (int column = 0; column < kAcross; ++column) {
      const cv::Point begin(inner.x + inner.width * column / kAcross, inner.y + inner.height * row / kDown);
      const cv::Point end(inner.x + inner.width * (column + 1) / kAcross, inner.y + inner.height * (row + 1) / kDown);
      if (end.x <= begin.x || end.y <= begin.y) continue;
      double highest = 0.0;
      cv::Point at;
      cv::minMaxLoc(cornerness_({begin, end}), nullptr, &highest, nullptr, &at);
      at += begin;
      const cv::Rect window(at.x - kFlow_px / 2, at.y - kFlow_px / 2, kFlow_px, kFlow_px);
      if (highest < kLeastCornerness || cv::countNonZero(from_.black(window)) > window.area() / 8) continue;
      const auto place = search(from_.coarse, at / from_.coarse_px, to_.coarse);
      if (!place) continue;
      corners_.emplace_back(at);
      found_.emplace_back(at + from_.coarse_px * (*place - at / from_.coarse_px));
    }
  }
}

void FreeMatcher::refine(float square_px) {
  matches_.clear();
  if (corners_.empty()) return;
  const cv::Size window(kFlow_px, kFlow_px);
  const cv::TermCriteria enough(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 20, 0.01);
  back_.resize(corners_.size());
  for (std::size_t i = 0; i < corners_.size(); ++i) back_[i] = corners_[i];
  cv::calcOpticalFlowPyrLK(from_.fine, to_.fine, corners_, found_, is_found_, errors_, window, 0, enough,
                           cv::OPTFLOW_USE_INITIAL_FLOW, 1e-3);
  cv::calcOpticalFlowPyrLK(to_.fine, from_.fine, found_, back_, is_back_, errors_, window, 0, enough,
                           cv::OPTFLOW_USE_INITIAL_FLOW, 1e-3);
  const cv::Point2f centre(0.5f, 0.5f);
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const cv::Point2f off = back_[i] - corners_[i];
    if (!is_found_[i] || !is_back_[i] || !(std::hypot(off.x, off.y) <= kBack_px)) continue;
    matches_.push_back({square_px * (corners_[i] + centre) - centre, square_px * (found_[i] + centre) - centre});
  }
}

const std::vector<FreeMatch>& FreeMatcher::match(const cv::Mat& from, const cv::Mat& to) {
  const int square_px = squareOf(from, kFineWidth_px);
  from_.make(from, square_px);
  to_.make(to, square_px);
  found_.clear();
  findCorners();
  refine(static_cast<float>(square_px));
  return matches_;
}

}  // namespace flight_corridor
