#include "flight_corridor/level_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace flight_corridor {

namespace {

constexpr int kHalfWidth_px = 15, kHalfHeight_px = 1;  // of the window
constexpr int kWindow_px = (2 * kHalfWidth_px + 1) * (2 * kHalfHeight_px + 1);
constexpr double kSmallestStep = 10.0;  // mean vertical step [grey/px] that is an edge
constexpr double kLevel = 2.0;          // an edge is level when steps across it are so many times those along it
constexpr int kNeighbours_px = 4;       // disparities beside the best one that cost nearly the same
constexpr double kUnique = 1.3;         // all others cost so many times the best one,
constexpr double kBetter = 1.5;         // the one matched before so many times
constexpr double kResidual = 0.5;       // and the best one so small a share of the edge itself
constexpr float kNearer_px = 1.5f;      // than the one matched before
constexpr float kNothing = -1e6f;       // below every disparity
constexpr int kShortestRun_px = 12;     // of pixels in a row that agree: fewer are chance

/// Runs of neighbours within a pixel stay when they are long.
void dropShortRuns(float* found_px, int count) {
  int first = 0;
  for (int u = 1; u <= count; ++u) {
    if (u < count && std::abs(found_px[u] - found_px[u - 1]) <= 1.0f) continue;
    if (u - first < kShortestRun_px) std::fill(found_px + first, found_px + u, kNothing);
    first = u;
  }
}

}  // namespace

LevelMatcher::LevelMatcher(int min_disparity_px, int num_disparities_px)
    : min_disparity_px_(min_disparity_px), num_disparities_px_(num_disparities_px) {}

void LevelMatcher::match(const cv::Mat& left, const cv::Mat& right, cv::Mat& disparity_px) {
  static const cv::Mat kStep = (cv::Mat_<float>(3, 1) << -0.5f, 0.0f, 0.5f);
  cv::filter2D(left, left_steps_, CV_8U, kStep, {-1, -1}, 128.0);
  cv::filter2D(right, right_steps_, CV_8U, kStep, {-1, -1}, 128.0);
  findLevelEdges(left);
  found_px_.create(left.size(), CV_32FC1);
  found_px_.setTo(kNothing);
  for (int v = kHalfHeight_px; v < left.rows - kHalfHeight_px; ++v) {
    const auto* across = across_.ptr<float>(v);
    const auto* along = along_.ptr<float>(v);
    const auto is_level_edge = [&](int u) { return across[u] >= kSmallestStep && across[u] >= kLevel * along[u]; };
    for (int u = kHalfWidth_px; u < left.cols - kHalfWidth_px; ++u) {
      if (!is_level_edge(u)) continue;
      const int first_u = u;
      while (u < left.cols - kHalfWidth_px && is_level_edge(u)) ++u;
      matchRun(v, first_u, u - 1, disparity_px.ptr<float>(v));
    }
  }
  // What was found holds for all rows of the window: a thin thing has hardly more.
  static const cv::Mat kRows = cv::getStructuringElement(cv::MORPH_RECT, {1, 2 * kHalfHeight_px + 1});
  cv::dilate(found_px_, nearest_px_, kRows);
  for (int v = 0; v < left.rows; ++v) {
    const auto* nearest_px = nearest_px_.ptr<float>(v);
    auto* d = disparity_px.ptr<float>(v);
    for (int u = 0; u < left.cols; ++u) {
      if (nearest_px[u] > kNothing && !(d[u] >= nearest_px[u])) d[u] = nearest_px[u];
    }
  }
}

/// Mean steps across and along the row, over the window.
void LevelMatcher::findLevelEdges(const cv::Mat& left) {
  cv::absdiff(left_steps_, cv::Scalar(128), vertical_);
  cv::Sobel(left, horizontal_, CV_16S, 1, 0, 1, 0.5);
  cv::convertScaleAbs(horizontal_, horizontal_);
  const cv::Size window(2 * kHalfWidth_px + 1, 2 * kHalfHeight_px + 1);
  cv::boxFilter(vertical_, across_, CV_32F, window);
  cv::boxFilter(horizontal_, along_, CV_32F, window);
}

/// Costs of all disparities for a run of pixels of one row; sums slide along the row.
void LevelMatcher::matchRun(int v, int first_u, int last_u, const float* matched_px) {
  const int count = last_u - first_u + 1, n = num_disparities_px_;
  costs_.assign(static_cast<std::size_t>(count) * n, UINT32_MAX);
  for (int i = 0; i < n; ++i) {
    const int d = min_disparity_px_ + i;
    const int first_column = std::max(first_u - kHalfWidth_px, std::max(d, 0));
    const int last_column = std::min(last_u + kHalfWidth_px, left_steps_.cols - 1 + std::min(d, 0));
    const int columns = last_column - first_column + 1;
    if (columns <= 2 * kHalfWidth_px) continue;
    column_.assign(static_cast<std::size_t>(columns), 0);
    for (int row = v - kHalfHeight_px; row <= v + kHalfHeight_px; ++row) {
      const auto* l = left_steps_.ptr<std::uint8_t>(row) + first_column;
      const auto* r = right_steps_.ptr<std::uint8_t>(row) + first_column - d;
      for (int k = 0; k < columns; ++k) column_[k] = static_cast<std::uint16_t>(column_[k] + std::abs(l[k] - r[k]));
    }
    std::uint32_t sum = 0;
    for (int k = 0; k < columns; ++k) {
      sum += column_[k];
      if (k > 2 * kHalfWidth_px) sum -= column_[k - 2 * kHalfWidth_px - 1];
      const int u = first_column + k - kHalfWidth_px;
      if (k >= 2 * kHalfWidth_px) costs_[static_cast<std::size_t>(u - first_u) * n + i] = sum;
    }
  }
  for (int u = first_u; u <= last_u; ++u) {
    const auto edge = static_cast<std::uint32_t>(across_.at<float>(v, u) * kWindow_px);
    found_px_.at<float>(v, u) = best(&costs_[static_cast<std::size_t>(u - first_u) * n], matched_px[u], edge);
  }
  dropShortRuns(found_px_.ptr<float>(v) + first_u, count);
}

/// The disparity that fits clearly best and is nearer than the one matched before; kNothing: none.
float LevelMatcher::best(const std::uint32_t* costs, float matched_px, std::uint32_t edge) const {
  const int last = num_disparities_px_ - 1;
  const int at = static_cast<int>(std::min_element(costs, costs + last + 1) - costs);
  if (at == 0 || at == last || !(costs[at] <= kResidual * edge)) return kNothing;
  // Between two whole disparities a cost is as low as the V through it and its neighbours says.
  const auto lowest = [&](int i) {
    const double left = costs[std::max(i - 1, 0)], right = costs[std::min(i + 1, last)];
    return costs[i] <= std::min(left, right) ? costs[i] - 0.5 * std::abs(left - right) : costs[i];
  };
  for (int i = 0; i <= last; ++i) {
    if (std::abs(i - at) > kNeighbours_px && lowest(i) < kUnique * costs[at]) return kNothing;
  }
  const float found_px = static_cast<float>(min_disparity_px_ + at);
  if (std::isnan(matched_px)) return found_px;
  const int before = std::clamp(static_cast<int>(std::lround(matched_px)) - min_disparity_px_, 0, last);
  return found_px >= matched_px + kNearer_px && lowest(before) >= kBetter * costs[at] ? found_px : kNothing;
}

}  // namespace flight_corridor
