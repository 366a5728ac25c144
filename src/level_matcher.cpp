#include "flight_corridor/level_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/imgproc.hpp>

namespace flight_corridor {

namespace {

constexpr int kBeside_px = 1;            // rows above and below in which an edge shows
constexpr int kNoStep = 128;             // of the images of steps
constexpr double kLevel = 2.0;           // an edge is level when steps across it are so many times those along it
constexpr int kNeighbours_px = 4;        // disparities beside the best one that cost nearly the same
constexpr double kUnique = 1.3;          // all others cost so many times the best one,
constexpr double kBetter = 1.5;          // the one matched before so many times
constexpr double kResidual = 0.5;        // and the best one so small a share of the edge itself
constexpr float kNearer_px = 1.5f;       // than the one matched before
constexpr float kNothing = -1e6f;        // below every disparity
constexpr std::uint16_t kLeastCost = 1;  // in an image without noise an exact repeat costs as little: nothing
constexpr int kShortestRun_px = 12;      // of pixels in a row that agree: fewer are chance

/// Adds what a step differs from a row of them. Without __restrict it is several times slower.
void addSteps(int step, const std::uint8_t* __restrict row, int count, std::uint16_t* __restrict costs) {
  for (int i = 0; i < count; ++i) costs[i] = static_cast<std::uint16_t>(costs[i] + std::abs(step - row[i]));
}

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

void LevelMatcher::match(const cv::Mat& left, const cv::Mat& right, cv::Mat& disparity_px, cv::Mat& level) {
  static const cv::Mat kStep = (cv::Mat_<float>(3, 1) << -0.5f, 0.0f, 0.5f);
  cv::filter2D(left, left_steps_, CV_8U, kStep, {-1, -1}, kNoStep);
  cv::filter2D(right, right_steps_, CV_8U, kStep, {-1, -1}, kNoStep);
  cv::flip(right_steps_, right_steps_, 1);  // its disparities ascend with the column
  cv::absdiff(left_steps_, cv::Scalar(kNoStep), vertical_);
  cv::Sobel(left, horizontal_, CV_16S, 1, 0, 1, 0.5);
  found_px_.create(left.size(), CV_32FC1);
  found_px_.setTo(kNothing);
  for (const Window& window : kWindows) find(window, disparity_px);
  // What was found holds for the rows beside it, too: a thin thing has hardly more.
  static const cv::Mat kRows = cv::getStructuringElement(cv::MORPH_RECT, {1, 2 * kBeside_px + 1});
  cv::dilate(found_px_, nearest_px_, kRows);
  level.create(left.size(), CV_8U);
  for (int v = 0; v < left.rows; ++v) {
    const auto* nearest_px = nearest_px_.ptr<float>(v);
    auto* d = disparity_px.ptr<float>(v);
    auto* is_level = level.ptr<std::uint8_t>(v);
    for (int u = 0; u < left.cols; ++u) {
      const bool is_nearer = nearest_px[u] > kNothing && !(d[u] >= nearest_px[u]);
      if (is_nearer) d[u] = nearest_px[u];
      is_level[u] = is_nearer ? 255 : 0;
    }
  }
}

/// Of what several windows tell the nearest holds: a longer one may lie across two things.
void LevelMatcher::find(const Window& window, const cv::Mat& disparity_px) {
  const int reach_px = window.reach_px, cols = disparity_px.cols;
  const cv::Size size(2 * reach_px + 1, 2 * kBeside_px + 1);
  cv::boxFilter(vertical_, across_, CV_32F, size);
  cv::boxFilter(cv::abs(horizontal_), along_, CV_32F, size);
  for (int v = kBeside_px; v < disparity_px.rows - kBeside_px; ++v) {
    const auto* across = across_.ptr<float>(v);
    const auto* along = along_.ptr<float>(v);
    const auto* matched_px = disparity_px.ptr<float>(v);
    row_px_.assign(cols, kNothing);
    for (int u = reach_px; u < cols - reach_px; u += window.stride_px) {
      if (across[u] >= window.smallest_step && across[u] >= kLevel * along[u]) {
        std::fill_n(row_px_.begin() + u, window.stride_px, disparityAt(u, v, reach_px, matched_px[u]));
      }
    }
    dropShortRuns(row_px_.data(), cols);
    auto* found_px = found_px_.ptr<float>(v);
    for (int u = 0; u < cols; ++u) found_px[u] = std::max(found_px[u], row_px_[u]);
  }
}

/// The disparity of a pixel of a level edge; kNothing: none is clearly best. Its window is one row high and follows the
/// edge: in the middle of a thin thing it holds nothing of what is behind.
float LevelMatcher::disparityAt(int u, int v, int reach_px, float matched_px) {
  const int first_px = std::max(min_disparity_px_, u + reach_px - (left_steps_.cols - 1));
  const int last_px = std::min(min_disparity_px_ + num_disparities_px_ - 1, u - reach_px);
  if (last_px < first_px) return kNothing;
  const int count = last_px - first_px + 1;
  costs_.assign(count, 0);
  const double slope = slopeAt(u, v, reach_px);
  int edge = 0;
  for (int k = -reach_px; k <= reach_px; ++k) {
    const int row = std::clamp(v + static_cast<int>(std::lround(slope * k)), 0, left_steps_.rows - 1);
    const int step = left_steps_.at<std::uint8_t>(row, u + k);
    edge += std::abs(step - kNoStep);
    addSteps(step, right_steps_.ptr<std::uint8_t>(row) + left_steps_.cols - 1 - (u + k - first_px), count,
             costs_.data());
  }
  return best(first_px, matched_px, edge);
}

/// Rows per column along which grey values vary least, around a pixel (structure tensor; Foerstner and Guelch 1987).
double LevelMatcher::slopeAt(int u, int v, int reach_px) const {
  double xy = 0.0, yy = 0.0;
  for (int row = v - kBeside_px; row <= v + kBeside_px; ++row) {
    const auto* vertical = left_steps_.ptr<std::uint8_t>(row);
    const auto* horizontal = horizontal_.ptr<std::int16_t>(row);
    for (int column = u - reach_px; column <= u + reach_px; ++column) {
      const int y = vertical[column] - kNoStep;
      xy += y * horizontal[column];
      yy += y * y;
    }
  }
  return -xy / yy;
}

/// The disparity that fits clearly best and is nearer than the one matched before; kNothing: none.
float LevelMatcher::best(int first_px, float matched_px, int edge) const {
  const std::vector<std::uint16_t>& costs = costs_;
  const int last = static_cast<int>(costs.size()) - 1;
  const int at = static_cast<int>(std::min_element(costs.begin(), costs.end()) - costs.begin());
  if (at == 0 || at == last || !(costs[at] <= kResidual * edge)) return kNothing;
  const double lowest_cost = std::max(costs[at], kLeastCost);
  // Between two whole disparities a cost is as low as the V through it and its neighbours says.
  const auto lowest = [&](int i) {
    const double left = costs[std::max(i - 1, 0)], right = costs[std::min(i + 1, last)];
    return costs[i] <= std::min(left, right) ? costs[i] - 0.5 * std::abs(left - right) : costs[i];
  };
  for (int i = 0; i <= last; ++i) {
    if (std::abs(i - at) > kNeighbours_px && lowest(i) < kUnique * lowest_cost) return kNothing;
  }
  const double left = costs[at - 1], right = costs[at + 1], steepness = std::max(left, right) - costs[at];
  const double tip = steepness > 0.0 ? 0.5 * (left - right) / steepness : 0.0;  // of that V, from its middle
  const float found_px = static_cast<float>(first_px + at + tip);
  if (std::isnan(matched_px)) return found_px;
  const int before = std::clamp(static_cast<int>(std::lround(matched_px)) - first_px, 0, last);
  return found_px >= matched_px + kNearer_px && lowest(before) >= kBetter * lowest_cost ? found_px : kNothing;
}

}  // namespace flight_corridor
