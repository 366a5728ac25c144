#include "flight_corridor/ambiguous_texture.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "flight_corridor/cross_sections.hpp"
#include "flight_corridor/window_matcher.hpp"

namespace flight_corridor {

namespace {

constexpr int kStride_px = 4;       // between neighbouring windows, at least
constexpr double kWindows = 400.0;  // looked at, at the most
constexpr int kFewest = 12;         // windows where something is known; fewer say nothing
constexpr double kMost = 0.5;       // of these
constexpr float kOwnFit = 0.8f;     // least correlation of the best match at or behind the surface
constexpr float kAsGood = 0.1f;     // by how much less another match may correlate
constexpr float kBetween = 0.5f;    // of the own fit: a worse match between two makes them two
constexpr int kBelowZero_px = 3;    // disparities below zero that are asked about: matches there are taken to be far

/// Of a peak between samples, by a parabola through three of them.
float peak(float before, float at, float after) {
  const float curvature = 2.0f * at - before - after;
  return at + (curvature > 0.0f ? (after - before) * (after - before) / (8.0f * curvature) : 0.0f);
}

/// @param correlations from the largest disparity downwards.  @param own_px, end_px the surface's disparity, at the
/// most, and the box's end's.
bool fitsTwice(const std::vector<float>& correlations, int largest_px, int own_px, int end_px) {
  float own = -1.0f, least = 1.0f;
  for (int k = static_cast<int>(correlations.size()) - 2; k > 0; --k) {
    const int at_px = largest_px - k;
    const float at = correlations[k], before = correlations[k - 1], after = correlations[k + 1];
    const bool is_peak = at >= before && at >= after;
    const float fit = is_peak ? peak(before, at, after) : at;
    if (at_px <= own_px) {
      own = std::max(own, fit);
      continue;
    }
    if (own < kOwnFit) return false;
    least = std::min(least, at);
    if (is_peak && at_px >= end_px && least < kBetween * own && fit >= own - kAsGood) return true;
  }
  return false;
}

}  // namespace

bool hasAmbiguousTexture(const Box& box_C, const StereoFrame& pair, const cv::Mat& depth_m, double nearest_m,
                         const StereoGeometry& geometry) {
  const cv::Rect view = viewOfFarPart(box_C, geometry);
  const double end_m = farthestCorner(box_C);
  if (view.empty() || !(end_m > 0.0)) return false;
  const double width_px = geometry.size().width;
  const auto wholePixels = [&](double disparity_px) {
    return static_cast<int>(std::lround(std::min(disparity_px, width_px) + geometry.principalPointDifference()));
  };
  const int nearest_px = wholePixels(geometry.disparity(nearest_m)), farthest_px = wholePixels(-kBelowZero_px);
  const int end_px = wholePixels(kSmallestScale * geometry.disparity(end_m));
  const int stride_px = std::max(kStride_px, static_cast<int>(std::ceil(std::sqrt(view.area() / kWindows))));
  const WindowMatcher matcher(pair.left, pair.right, {view.y, view.br().y}, WindowMatcher::kLargestReach_px);
  std::vector<float> correlations;
  int known = 0, fitting_twice = 0;
  for (int v = view.y; v < view.br().y; v += stride_px) {
    for (int u = view.x; u < view.br().x; u += stride_px) {
      const float own_m = depth_m.at<float>(v, u);
      if (std::isnan(own_m)) continue;
      ++known;
      if (!(own_m > end_m)) continue;
      const int largest_px = matcher.correlations(u, v, farthest_px, nearest_px, correlations);
      const int own_px = wholePixels(geometry.disparity(own_m) / kSmallestScale) + 1;
      fitting_twice += fitsTwice(correlations, largest_px, own_px, end_px);
    }
  }
  return known >= kFewest && fitting_twice >= kMost * known;
}

}  // namespace flight_corridor
