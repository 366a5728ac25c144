#include "flight_corridor/ambiguous_texture.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "flight_corridor/cross_sections.hpp"
#include "flight_corridor/window_matcher.hpp"

namespace flight_corridor {

namespace {

constexpr int kStride_px = 4;      // between neighbouring windows
constexpr double kMost = 0.5;      // of the windows
constexpr float kOwnFit = 0.8f;    // least correlation of a surface where it was matched
constexpr float kAsGood = 0.1f;    // by how much less another match may correlate
constexpr float kBetween = 0.5f;   // of the own fit: a worse match between two makes them two
constexpr double kBehind = 1.05;   // a surface's depth by the box's end, at least
constexpr int kNeighbourhood = 1;  // [px] about a match

/// Of a peak between samples, by a parabola through three of them.
float peak(float before, float at, float after) {
  const float curvature = 2.0f * at - before - after;
  return at + (curvature > 0.0f ? (after - before) * (after - before) / (8.0f * curvature) : 0.0f);
}

/// @param correlations from the largest disparity downwards.
bool fitsTwice(const std::vector<float>& correlations, int largest_px, int own_px, int end_px) {
  float own = -1.0f, least = 1.0f;
  for (int k = static_cast<int>(correlations.size()) - 2; k > 0; --k) {
    const int at_px = largest_px - k;
    const float at = correlations[k], before = correlations[k - 1], after = correlations[k + 1];
    const bool is_peak = at >= before && at >= after;
    const float fit = is_peak ? peak(before, at, after) : at;
    if (at_px <= own_px + kNeighbourhood) {
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
  const std::vector<cv::Rect> views = crossSections(box_C, geometry);
  const double end_m = (box_C.T_M_F * Eigen::Vector3d(box_C.size_m.x(), 0.0, 0.0)).z();
  if (views.empty() || !(end_m > 0.0)) return false;
  const cv::Rect view = views[std::min<std::size_t>(1, views.size() - 1)];
  const auto wholePixels = [&](double disparity_px) {
    return static_cast<int>(std::lround(disparity_px + geometry.principalPointDifference()));
  };
  const int nearest_px = wholePixels(geometry.disparity(nearest_m)), farthest_px = wholePixels(0.0) - 1;
  const int end_px = wholePixels(geometry.disparity(end_m));
  const WindowMatcher matcher(pair.left, pair.right, {view.y, view.br().y}, WindowMatcher::kLargestReach_px);
  std::vector<float> correlations;
  int asked = 0, fitting_twice = 0;
  for (int v = view.y; v < view.br().y; v += kStride_px) {
    for (int u = view.x; u < view.br().x; u += kStride_px) {
      ++asked;
      const float own_m = depth_m.at<float>(v, u);
      if (!(own_m > kBehind * end_m)) continue;
      const int largest_px = matcher.correlations(u, v, farthest_px, nearest_px, correlations);
      fitting_twice += fitsTwice(correlations, largest_px, wholePixels(geometry.disparity(own_m)), end_px);
    }
  }
  return fitting_twice >= kMost * asked;
}

}  // namespace flight_corridor
