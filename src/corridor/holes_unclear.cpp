#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "flight_corridor/corridor/holes.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"

// Which pixels of a plane no ray shows clear.

namespace flight_corridor {

namespace {

constexpr int kBlocks = 3;            // along a square that hides the smallest obstacle
constexpr float kTouching_px = 1.0f;  // a match so near to a place is of a surface that may be there

}  // namespace

/// Of a row of the plane, as in Place::unclear: pixels that both cameras see, and whose place no ray of the newest pair
/// shows clear.
void Holes::findUnclear(int row, const Plane& plane, const Place& place, const Absence& absence,
                        std::uint8_t* unclear) {
  const int v = plane.view.y + plane.stride_px * row, columns = place.unclear.cols, stride = plane.stride_px;
  const int seen_from = std::clamp((place.shift_px - plane.view.x + stride - 1) / stride, 0, columns);
  std::fill_n(unclear, seen_from, std::uint8_t{0});
  std::fill(unclear + seen_from, unclear + columns, std::uint8_t{1});
  if (!place.is_searched) return;
  const cv::Mat &left = absence.rays.metLeft(), &right = absence.rays.metRight();
  const float *left_px = left.ptr<float>(v) + plane.view.x, *right_px = right.ptr<float>(v), at_px = place.at_px;
  const int first_right = plane.view.x - place.shift_px;
  const int right_end = std::clamp((right.cols - first_right + stride - 1) / stride, seen_from, columns);
  for (int i = seen_from; i < columns; ++i) unclear[i] = !(left_px[i * stride] < at_px);
  for (int i = seen_from; i < right_end; ++i) unclear[i] &= !(right_px[first_right + i * stride] < at_px);
}

/// Whether earlier pairs saw it clear: that holds as long as the newest shows nothing there nor nearer, and nothing may
/// have come before what they saw.
bool Holes::wasClear(int u, int v, const Place& place, const Absence& absence) {
  if (!place.is_searched || absence.earlier.hasVanished(u, v)) return false;
  const float best_px = absence.matches.best_px.at<float>(v, u);
  float match_px = std::isnan(best_px) ? absence.matches.repeated_px.at<float>(v, u) : best_px;
  const bool has_nearer = std::isnan(best_px) && (absence.matches.flags.at<std::uint8_t>(v, u) & kCompetitor) != 0;
  if (has_nearer)
    match_px = std::max(match_px, place.first_px + absence.matches.competitor_nearest.at<std::uint8_t>(v, u));
  return !(match_px >= place.measured_px - kTouching_px) && place.earlier.wasClear(u, v);
}

/// Rows of a surface without texture are cleared one by one, up to their ends, of which some may be wrong. A gap
/// between rows that end nearer is unclear, too, if it is lower than the smallest obstacle.
void Holes::closeGaps(const Plane& plane, Place& place, const Absence& absence) {
  const int stride = plane.stride_px;
  bare_.create(place.unclear.size(), CV_8UC1);
  closed_.create(place.unclear.size(), CV_8UC1);
  for (int row = 0; row < bare_.rows; ++row) {
    const int v = plane.view.y + stride * row;
    const std::uint8_t *textured = absence.textured.ptr(v) + plane.view.x, *unclear = place.unclear.ptr(row);
    const float* met_px = absence.rays.metLeft().ptr<float>(v) + plane.view.x;
    auto *bare = bare_.ptr(row), *ends = closed_.ptr(row);
    for (int i = 0; i < bare_.cols; ++i) {
      bare[i] = textured[i * stride] == 0;
      ends[i] = bare[i] & unclear[i] & (met_px[i * stride] < kInfinity);
    }
  }
  if (cv::countNonZero(closed_) == 0) return;
  const int reach = static_cast<int>(place.edge / kHole / 2.0);  // half of the smallest obstacle
  cv::morphologyEx(closed_, closed_, cv::MORPH_CLOSE, cv::Mat::ones(2 * reach + 1, 1, CV_8UC1));
  cv::bitwise_and(closed_, bare_, closed_);
  cv::bitwise_or(place.unclear, closed_, place.unclear);
}

/// Pixels in squares become clear where earlier pairs saw them clear. Of a block whose middle they did not, the rest is
/// not asked about: it stays unclear.
void Holes::askEarlier(const Plane& plane, Place& place, const Absence& absence) {
  const int block = std::max(1, place.edge / kBlocks);
  const auto was_clear = [&](int row, int column) {
    return wasClear(plane.view.x + plane.stride_px * column, plane.view.y + plane.stride_px * row, place, absence);
  };
  for (int first_row = 0; first_row < place.unclear.rows; first_row += block) {
    const int end_row = std::min(first_row + block, place.unclear.rows);
    for (int first_column = 0; first_column < place.unclear.cols; first_column += block) {
      const int end_column = std::min(first_column + block, place.unclear.cols);
      const int row = (first_row + end_row) / 2, column = (first_column + end_column) / 2;
      if (place.unclear.at<std::uint8_t>(row, column) && !was_clear(row, column)) continue;
      for (int i = first_row; i < end_row; ++i) {
        for (int j = first_column; j < end_column; ++j) {
          const bool is_asked = place.unclear.at<std::uint8_t>(i, j) && in_squares_.at<std::uint8_t>(i, j);
          if (is_asked && was_clear(i, j)) place.unclear.at<std::uint8_t>(i, j) = 0;
        }
      }
    }
  }
}

/// Pixels that both cameras see and neither's ray is clear; and where squares of them end that hide the smallest
/// obstacle. Only in such squares earlier pairs are asked.
void Holes::findUnclear(const Plane& plane, Place& place, const Absence& absence) {
  const int stride = plane.stride_px;
  place.unclear.create((plane.view.height + stride - 1) / stride, (plane.view.width + stride - 1) / stride, CV_8UC1);
  for (int row = 0; row < place.unclear.rows; ++row) findUnclear(row, plane, place, absence, place.unclear.ptr(row));
  closeGaps(plane, place, absence);
  const cv::Mat square = cv::Mat::ones(place.edge, place.edge, CV_8UC1);
  const auto find_squares = [&] {
    cv::erode(place.unclear, hides_, square, {place.edge - 1, place.edge - 1}, 1, cv::BORDER_CONSTANT, 0);
  };
  find_squares();
  if (place.is_searched && !absence.earlier.empty() && cv::countNonZero(hides_) > 0) {
    cv::dilate(hides_, in_squares_, square, {0, 0}, 1, cv::BORDER_CONSTANT, 0);
    askEarlier(plane, place, absence);
    find_squares();
  }
  cv::integral(place.unclear, unclear_sum_, CV_32S);
  cv::integral(hides_, hides_sum_, CV_32S);
}

cv::Mat Holes::image(const Absence& absence) const {
  cv::Mat shown = cv::Mat::zeros(geometry_.size(), CV_8UC1);
  std::vector<std::uint8_t> unclear(geometry_.size().width);  // in the newest pair
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Plane& plane = planes_[i];
    const int stride = plane.stride_px;
    if (plane.view.empty() || !places_[i].is_searched) continue;
    for (int row = 0; row < places_[i].unclear.rows; ++row) {
      findUnclear(row, plane, places_[i], absence, unclear.data());
      for (int column = 0; column < places_[i].unclear.cols; ++column) {
        const int u = plane.view.x + stride * column, v = plane.view.y + stride * row;
        const Eigen::Vector3f p_F = fan_.T_F_C() * geometry_.point(u, v, plane.depth_m).cast<float>();
        const bool is_in_view = places_[i].shift_px <= u;  // of both cameras
        if (!is_in_view || !fan_.contains(fan_.turned(0, p_F))) continue;
        const Sighted sighted = places_[i].unclear.at<std::uint8_t>(row, column) ? Sighted::Unclear
                                : unclear[column]                                ? Sighted::ClearBefore
                                                                                 : Sighted::Clear;
        for (int y = v; y < std::min(v + stride, shown.rows); ++y) {
          auto* pixels = shown.ptr(y);
          for (int x = u; x < std::min(u + stride, shown.cols); ++x) {
            pixels[x] = std::max(pixels[x], static_cast<std::uint8_t>(sighted));
          }
        }
      }
    }
  }
  return shown;
}

}  // namespace flight_corridor
