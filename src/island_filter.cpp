#include "flight_corridor/island_filter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "flight_corridor/window_matcher.hpp"

namespace flight_corridor {

namespace {

constexpr int kLargest_px = 400;     // pixels of an island: larger ones are taken at their word
constexpr int kSmallest_px = 40;     // of a thing
constexpr int kSameSurface_px = 3;   // from a surface of which an island may be a part, seen through a gap
constexpr int kAround_px = 32;       // so far beside an island its surroundings are looked at
constexpr double kSurface = 0.05;    // of the matches there are a surface
constexpr double kMargin = 0.35;     // of its pixels more fit where a thing was matched than on any surface around;
constexpr double kByChance = 0.1;    // where few fit on a surface, twice as many and this share more are enough
constexpr double kLeast = 0.2;       // of a larger mistake's pixels fit on a surface around
constexpr double kUnclaimed = 0.25;  // of the pixels must have a say
constexpr int kFixedPoint = 16;
constexpr int kLowest_px = std::numeric_limits<std::int16_t>::min() / kFixedPoint;

int wholePixels(int fixed) { return static_cast<int>(std::floor(static_cast<double>(fixed) / kFixedPoint)); }

}  // namespace

IslandFilter::IslandFilter(int speckle_px, int step_px) : speckle_px_(speckle_px), step_(step_px * kFixedPoint) {}

void IslandFilter::filter(const cv::Mat& left, const cv::Mat& right, cv::Mat& fixed, std::int16_t none,
                          cv::Mat& small) {
  small.create(fixed.size(), CV_8U);
  small.setTo(0);
  if (speckle_px_ == 0) return;
  cv::filterSpeckles(fixed, none, std::min(speckle_px_, kSmallest_px), step_, speckles_);
  fixed.copyTo(surfaces_);
  cv::filterSpeckles(surfaces_, none, std::max(speckle_px_, kLargest_px), step_, speckles_);
  cv::compare(fixed, surfaces_, islands_, cv::CMP_NE);
  if (cv::countNonZero(islands_) == 0) return;
  surfaces_.setTo(std::numeric_limits<std::int16_t>::min(), surfaces_ == none);
  claimed_.create(fixed.size(), CV_8U);
  claimed_.setTo(0);
  const WindowMatcher matcher(left, right, {0, left.rows});
  for (int v = 0; v < fixed.rows; ++v) {
    for (int u = 0; u < fixed.cols; ++u) {
      if (!islands_.at<std::uint8_t>(v, u)) continue;
      takeIsland(fixed, {u, v});
      const bool is_thing = isThing(matcher, fixed);
      for (const cv::Point& pixel : island_) {
        if (!is_thing) fixed.at<std::int16_t>(pixel) = none;
        if (is_thing && isSpeckle()) small.at<std::uint8_t>(pixel) = 255;
      }
    }
  }
}

/// The neighbours of a pixel that belong to its island, and theirs.
void IslandFilter::takeIsland(const cv::Mat& fixed, const cv::Point& start) {
  const cv::Rect image({}, fixed.size());
  island_.assign(1, start);
  islands_.at<std::uint8_t>(start) = 0;
  double sum = 0.0;
  for (std::size_t i = 0; i < island_.size(); ++i) {
    const cv::Point pixel = island_[i];
    const int here = fixed.at<std::int16_t>(pixel);
    sum += here;
    for (const cv::Point& side : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
      const cv::Point next = pixel + side;
      if (!image.contains(next) || !islands_.at<std::uint8_t>(next)) continue;
      if (std::abs(fixed.at<std::int16_t>(next) - here) > step_) continue;
      islands_.at<std::uint8_t>(next) = 0;
      island_.push_back(next);
    }
  }
  island_px_ = wholePixels(static_cast<int>(sum / static_cast<double>(island_.size())));
}

bool IslandFilter::isThing(const WindowMatcher& matcher, const cv::Mat& fixed) {
  findSurfaces();
  const bool is_part = std::any_of(surfaces_px_.begin(), surfaces_px_.end(), [&](int surface_px) {
    return std::abs(surface_px - island_px_) <= kSameSurface_px;
  });
  if (is_part) return !isSpeckle();
  if (isSpeckle() && (surfaces_px_.empty() || surfaces_px_.back() > island_px_)) return false;
  const double own = ownShare(matcher, fixed);
  return std::none_of(surfaces_px_.begin(), surfaces_px_.end(), [&](int surface_px) {
    const double share =
        std::max(shareOn(surface_px, Side::Left, matcher, fixed), shareOn(surface_px, Side::Right, matcher, fixed));
    return own < share + std::min(share + kByChance, kMargin) && (isSpeckle() || share >= kLeast);
  });
}

/// Disparities of the surfaces around the island, in whole pixels, the nearest last.
void IslandFilter::findSurfaces() {
  const cv::Point reach(kAround_px, kAround_px);
  const cv::Rect box = cv::boundingRect(island_);
  const cv::Rect around = cv::Rect(box.tl() - reach, box.br() + reach) & cv::Rect({}, surfaces_.size());
  matches_.assign(-2 * kLowest_px, 0);
  int total = 0;
  for (int v = around.y; v < around.br().y; ++v) {
    const auto* surface = surfaces_.ptr<std::int16_t>(v);
    for (int u = around.x; u < around.br().x; ++u) {
      if (surface[u] == std::numeric_limits<std::int16_t>::min()) continue;
      ++matches_[wholePixels(surface[u]) - kLowest_px];
      ++total;
    }
  }
  surfaces_px_.clear();
  for (std::size_t i = 0; i < matches_.size(); ++i) {
    if (matches_[i] > 0 && matches_[i] >= kSurface * total) surfaces_px_.push_back(static_cast<int>(i) + kLowest_px);
  }
}

/// Share of the island's pixels that fit where they were matched.
double IslandFilter::ownShare(const WindowMatcher& matcher, const cv::Mat& fixed) {
  const auto fitting = std::count_if(island_.begin(), island_.end(), [&](const cv::Point& pixel) {
    const int own_px = wholePixels(fixed.at<std::int16_t>(pixel));
    return matcher.fits(pixel.x, pixel.y, own_px, own_px + 1, scratch_);
  });
  return static_cast<double>(fitting) / static_cast<double>(island_.size());
}

/// Share of what the island shows in one image that fits on a surface. What would fit on the island's own picture in
/// the other image has no say: level stripes fit on themselves.
double IslandFilter::shareOn(int surface_px, Side side, const WindowMatcher& matcher, const cv::Mat& fixed) {
  const auto column = [&](const cv::Point& pixel, Side of) {
    return of == Side::Left ? pixel.x : pixel.x - wholePixels(fixed.at<std::int16_t>(pixel));
  };
  const Side other = side == Side::Left ? Side::Right : Side::Left;
  const auto claim = [&](std::uint8_t claimed) {
    for (const cv::Point& pixel : island_) {
      const int u = column(pixel, other);
      if (0 <= u && u < claimed_.cols) claimed_.at<std::uint8_t>(pixel.y, u) = claimed;
    }
  };
  claim(1);
  int fitting = 0, asked = 0;
  for (const cv::Point& pixel : island_) {
    const int here = column(pixel, side);
    const int there = side == Side::Left ? here - surface_px : here + surface_px;
    if (there < 1 || there >= claimed_.cols || claimed_.at<std::uint8_t>(pixel.y, there) ||
        claimed_.at<std::uint8_t>(pixel.y, there - 1))
      continue;
    ++asked;
    fitting += matcher.fits(side == Side::Left ? here : there, pixel.y, surface_px, surface_px + 1, scratch_);
  }
  claim(0);
  return asked >= kUnclaimed * static_cast<double>(island_.size()) ? static_cast<double>(fitting) / asked : 0.0;
}

}  // namespace flight_corridor
