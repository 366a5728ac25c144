#include "flight_corridor/corridor/railing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "flight_corridor/geometry/section.hpp"
#include "flight_corridor/stereo/match_error.hpp"
#include "flight_corridor/stereo/window_matcher.hpp"

namespace flight_corridor {

namespace {

constexpr float kFitsAsWell = 0.1f;  // by how much less another match may correlate
constexpr float kBetween = 0.5f;     // of the own fit: a worse match between two makes them two
constexpr float kOwnFit = 0.8f;      // least correlation of the best match at or behind the surface

constexpr int kBarStride_px = 2;           // between windows
constexpr double kBarWindows = 3000.0;     // looked at, at the most: fewer rows, for columns meet the bars' pitch
constexpr int kShared = 3;                 // ... but of several boxes in each this part of them
constexpr float kBarTexture = 3.0f;        // grey levels: mean gradient along the row in a window's middle
constexpr int kMiddle_px = 3;              // ... which is so wide and high
constexpr double kWiderThanHigh = 2.5;     // the view of a row of bars, at least
constexpr double kLargestScale = 1.2;      // upper bound of true over measured depth
constexpr double kBeside_px = 2.0;         // so far beside its surface a window may fit
constexpr int kFewestFitting = 40;         // windows; fewer prove nothing
constexpr double kRailingShare = 0.23;     // of these; doc/decisions.md has the shares of other scenes
constexpr double kInARow = 0.2;            // of its windows; of two trees that look alike hardly any
constexpr double kPatternOnlyShare = 0.7;  // of these: no wall is seen between the bars
constexpr double kWidePitch_m = 0.3;       // of bars at their match's distance: farther apart than those of fences
constexpr double kWideInARow = 0.4;        // of their windows, at least; of a forest's fewer are
constexpr double kOfAPitch = 0.6;          // of the most windows: as many agree on the pitch, most on a multiple
constexpr double kFarther_px = 1.0;        // with this much less disparity a surface beside a fence is farther
constexpr double kFartherShare = 0.1;      // of it, at least

/// A window that has a match in the box.
struct Bar {
  cv::Point at;
  double surface_px;  // disparity of its own match
  int offset_px;      // of its match in the box from that
};

using Bars = std::vector<Bar>;

/// Those of one surface and one offset, give or take a pixel.
struct Railing {
  int at_px = 0, offset_px = 0;
  std::size_t windows = 0;
  double surface_px = 0.0;  // their mean

  bool has(const Bar& bar) const {
    return std::abs(static_cast<int>(std::lround(bar.surface_px)) - at_px) <= 1 &&
           std::abs(bar.offset_px - offset_px) <= 1;
  }
};

Railing railingOf(const Bars& bars, int at_px, int offset_px) {
  Railing railing{at_px, offset_px};
  for (const Bar& bar : bars) {
    if (!railing.has(bar)) continue;
    ++railing.windows;
    railing.surface_px += bar.surface_px;
  }
  if (railing.windows > 0) railing.surface_px /= static_cast<double>(railing.windows);
  return railing;
}

/// The most of them.
Railing largestRailing(const Bars& bars) {
  std::map<std::pair<int, int>, int> windows;
  for (const Bar& bar : bars) ++windows[{static_cast<int>(std::lround(bar.surface_px)), bar.offset_px}];
  int most = 0, surface_px = 0, offset_px = 0;
  for (const auto& [key, count] : windows) {
    int like = 0;
    for (const int nearer_px : {-1, 0, 1}) {
      for (const int wider_px : {-1, 0, 1}) {
        const auto other = windows.find({key.first + nearer_px, key.second + wider_px});
        if (other != windows.end()) like += other->second;
      }
    }
    if (like > most) most = like, surface_px = key.first, offset_px = key.second;
  }
  return railingOf(bars, surface_px, offset_px);
}

/// Of the same surface, by the least offset on which nearly as many agree: equal bars fit on each next one, and on
/// those after it.
Railing byItsPitch(const Railing& railing, const Bars& bars) {
  const int surface_px = static_cast<int>(std::lround(railing.surface_px));
  for (int offset_px = 1; offset_px <= railing.offset_px / 2 + 1; ++offset_px) {
    const Railing other = railingOf(bars, surface_px, offset_px);
    if (other.windows < kOfAPitch * railing.windows) continue;
    const Railing next = railingOf(bars, surface_px, offset_px + 1);
    return next.windows > other.windows ? next : other;
  }
  return railing;
}

/// Share of a railing's windows in whose place on the next bar, on which their own was matched, there is one of it,
/// too.
/// @param out_of_view the answer when all those places are.
double shareInARow(const Railing& railing, const Bars& bars, const cv::Rect& view, double out_of_view) {
  std::vector<bool> is_bar(static_cast<std::size_t>(view.area()));
  const auto place = [&](int u, int v) { return is_bar.begin() + (v - view.y) * view.width + u - view.x; };
  for (const Bar& bar : bars) {
    if (railing.has(bar)) *place(bar.at.x, bar.at.y) = true;
  }
  int in_view = 0, in_a_row = 0;
  for (const Bar& bar : bars) {
    const int first_u = bar.at.x + railing.offset_px - kBarStride_px / 2, end_u = first_u + kBarStride_px + 1;
    if (!railing.has(bar) || end_u > view.br().x) continue;
    const auto next = place(first_u, bar.at.y), end = place(end_u, bar.at.y);
    ++in_view;
    in_a_row += std::find(next, end, true) != end;
  }
  return in_view > 0 ? static_cast<double>(in_a_row) / in_view : out_of_view;
}

/// Whether the bars, at their match's distance, would be farther apart than those of a fence.
/// @param least_px smaller offsets are not in the box: half of the railing's must be, or it may be twice the pitch.
bool isTooWideForAFence(const Railing& railing, const Bars& bars, double least_px, const cv::Rect& view,
                        const StereoGeometry& geometry) {
  const double pitch_m = railing.offset_px * geometry.depth(railing.surface_px) / geometry.calibration().fx_px;
  return railing.offset_px >= 2.0 * least_px && pitch_m > kWidePitch_m &&
         shareInARow(railing, bars, view, 0.0) >= kWideInARow;
}

/// Mean gradient along the row in a window's middle [grey levels].
float textureAt(const cv::Mat& image, int u, int v) {
  int sum = 0;
  for (int i = 0; i < kMiddle_px * kMiddle_px; ++i) {
    const auto* pixel =
        image.ptr<std::uint8_t>(v + i / kMiddle_px - kMiddle_px / 2, u + i % kMiddle_px - kMiddle_px / 2);
    sum += std::abs(cvRound(0.5 * (pixel[1] - pixel[-1])));
  }
  return static_cast<float>(sum) / static_cast<float>(kMiddle_px * kMiddle_px);
}

/// Whether many matches in and around a view are behind a surface.
bool showsFarther(const cv::Rect& view, double surface_px, const cv::Mat& depth_m, const StereoGeometry& geometry) {
  const cv::Rect around = cv::Rect(view.tl() - cv::Point(view.size()), view.size() * 3) & cv::Rect({}, depth_m.size());
  const double farther_px = surface_px - kFarther_px;
  if (!(farther_px > 0.0)) return false;  // nothing is farther than a surface that is nearly at infinity
  const auto beyond_m = static_cast<float>(geometry.depth(farther_px));
  int known = 0, farther = 0;
  for (int v = around.y; v < around.br().y; ++v) {
    for (int u = around.x; u < around.br().x; ++u) {
      known += depth_m.at<float>(v, u) > 0.0f;
      farther += depth_m.at<float>(v, u) > beyond_m;
    }
  }
  return farther >= kFartherShare * known;
}

/// A peak between samples, by a parabola through three of them.
float peakOf(float before, float at, float after) {
  const float curvature = 2.0f * at - before - after;
  return at + (curvature > 0.0f ? (after - before) * (after - before) / (8.0f * curvature) : 0.0f);
}

/// Where a box may hold a railing: a row of bars is wider than high, however narrow the box.
cv::Rect viewOfRow(const Box& box_C, const StereoGeometry& geometry) {
  const cv::Rect view = viewOfFarPart(box_C, geometry);
  const int beside_px = std::max(0, (static_cast<int>(kWiderThanHigh * view.height) - view.width) / 2);
  return (view + cv::Size(2 * beside_px, 0) - cv::Point(beside_px, 0)) & cv::Rect({}, geometry.size());
}

}  // namespace

struct Railings::Window {
  bool is_looked_at = false, fits = false;
  int own_px = 0;               // where it fits best, at or behind its surface
  std::vector<int> offsets_px;  // by which nearer it fits nearly as well
};

Railings::Railings(const StereoGeometry& geometry) : geometry_(geometry) {}
Railings::~Railings() = default;

void Railings::look(const Fan& fan, const StereoFrame& pair, const cv::Mat& depth_m, double nearest_m) {
  pair_ = pair;
  depth_m_ = depth_m;
  cv::Rect view;
  int area_px = 0;
  for (int i = 0; i < fan.size(); ++i) {
    const cv::Rect part = viewOfRow(fan.box(i), geometry_);
    view |= part;
    area_px = std::max(area_px, part.area());
  }
  constexpr int kReach_px = WindowMatcher::kReach_px;
  view &= cv::Rect(kReach_px, kReach_px, pair.left.cols - 2 * kReach_px, pair.left.rows - 2 * kReach_px);
  view_ = view;
  const double windows = kBarWindows / std::min(fan.size(), kShared);
  rows_px_ = std::max(kBarStride_px, static_cast<int>(std::ceil(area_px / (kBarStride_px * windows))));
  nearest_px_ = wholePixels(geometry_.disparity(nearest_m));
  windows_.assign(static_cast<std::size_t>(view.width / kBarStride_px + 1) * (view.height / rows_px_ + 1), {});
  if (!view.empty()) matcher_.emplace(pair.left, pair.right, cv::Range(view.y, view.br().y));
}

int Railings::wholePixels(double disparity_px) const {
  const double width_px = geometry_.size().width;
  return static_cast<int>(std::lround(std::min(disparity_px, width_px) + geometry_.principalPointDifference()));
}

/// A match counts that is as good as the best at or behind the surface, with a worse one between the two, and between
/// any two.
const Railings::Window& Railings::window(int u, int v) {
  Window& window =
      windows_[(v - view_.y) / rows_px_ * (view_.width / kBarStride_px + 1) + (u - view_.x) / kBarStride_px];
  if (std::exchange(window.is_looked_at, true) || textureAt(pair_.left, u, v) < kBarTexture) return window;
  const double surface_px = geometry_.disparity(depth_m_.at<float>(v, u));
  const int farthest_px = wholePixels(surface_px / kLargestScale - kBeside_px);
  const int largest_px = matcher_->correlations(u, v, farthest_px, nearest_px_, correlations_);
  const int surface_at_px = wholePixels(surface_px / kSmallestScale) + 1;
  float own = -1.0f, least = 1.0f;
  for (int k = static_cast<int>(correlations_.size()) - 2; k > 0; --k) {
    const int at_px = largest_px - k;
    const float at = correlations_[k], before = correlations_[k - 1], after = correlations_[k + 1];
    const bool is_peak = at >= before && at >= after;
    const float fit = is_peak ? peakOf(before, at, after) : at;
    if (at_px <= surface_at_px) {
      if (fit > own) own = fit, window.own_px = at_px;
      continue;
    }
    if (own < kOwnFit) break;
    least = std::min(least, at);
    if (is_peak && least < kBetween * own && fit >= own - kFitsAsWell) {
      window.offsets_px.push_back(at_px - window.own_px);
      least = 1.0f;
    }
  }
  window.fits = own >= kOwnFit;
  return window;
}

bool Railings::mayBeIn(const Box& box_C, double lidar_px) {
  const cv::Rect view = viewOfRow(box_C, geometry_) & view_;
  const double end_m = farthestCorner(box_C);
  if (view.empty() || !(end_m > 0.0)) return false;
  const int end_px = wholePixels(kSmallestScale * geometry_.disparity(end_m));
  const auto from = [](int first, int begin, int step) { return begin + (first - begin + step - 1) / step * step; };
  Bars bars;
  int fitting = 0;
  for (int v = from(view.y, view_.y, rows_px_); v < view.br().y; v += rows_px_) {
    for (int u = from(view.x, view_.x, kBarStride_px); u < view.br().x; u += kBarStride_px) {
      const float own_m = depth_m_.at<float>(v, u);
      if (!(own_m > end_m)) continue;
      const Window& window = this->window(u, v);
      fitting += window.fits;
      for (const int offset_px : window.offsets_px) {
        if (window.own_px + offset_px >= end_px) bars.push_back({{u, v}, geometry_.disparity(own_m), offset_px});
      }
    }
  }
  const Railing railing = largestRailing(bars);
  const auto windows = static_cast<double>(railing.windows);
  if (fitting < kFewestFitting || windows < kRailingShare * fitting) return false;
  if (isOneSurface(railing.surface_px, lidar_px) && windows >= kPatternOnlyShare * fitting) return false;
  if (!(shareInARow(railing, bars, view, 1.0) >= kInARow)) return false;
  const double least_px = geometry_.disparity(end_m) - railing.surface_px;
  return isTooWideForAFence(byItsPitch(railing, bars), bars, least_px, view, geometry_) ||
         !showsFarther(view, railing.surface_px, depth_m_, geometry_);
}

}  // namespace flight_corridor
