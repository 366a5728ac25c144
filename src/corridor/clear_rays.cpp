#include "flight_corridor/corridor/clear_rays.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "flight_corridor/stereo/match_error.hpp"
#include "flight_corridor/stereo/search_range.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"

namespace flight_corridor {

namespace {

constexpr float kUnknown_px = std::numeric_limits<float>::infinity();
constexpr auto kNoise_px = static_cast<float>(kMatchNoise_px);
constexpr int kEndMatches = 3;            // beside a run without texture, at least
constexpr int kFaintEdge_px = 7;          // an edge has gaps so wide
constexpr float kSteepest = 1.7320508f;   // tan(60 deg): slope of a surface that the LiDAR still ranges
constexpr float kOtherSurface_px = 1.0f;  // a match that is nearer by more shows another surface

}  // namespace

ClearRays::ClearRays(const StereoGeometry& geometry)
    : geometry_(geometry),
      first_px_(firstDisparity(geometry)),
      kept_px_(geometry.size(), CV_32FC1),
      met_left_px_(geometry.size(), CV_32FC1),
      met_right_px_(geometry.size(), CV_32FC1) {}

void ClearRays::look(int part, const DisparityEvidence& evidence, const cv::Mat& left, const cv::Mat& right,
                     const ScaleCorrection& correction) {
  const int rows = met_left_px_.rows, begin = rows * part / kParts, end = rows * (part + 1) / kParts;
  kept_px_.rowRange(begin, end).setTo(0.0);
  for (int v = begin; v < end; ++v) {
    lookAlong(v, evidence, left.ptr(v), correction);
    clearTexturelessRuns(v, evidence, left.ptr(v), right.ptr(v));
  }
}

/// An edge that is fainter in places still parts two surfaces: the texture is grown before the region is, and the
/// region grown back.
void ClearRays::clearPlainSurface(const DisparityEvidence& evidence, const cv::Mat& textured,
                                  const ScaleCorrection& correction, const Eigen::Vector3d& met_C) {
  const Eigen::Vector2d at_px = geometry_.project(met_C);
  if (!geometry_.contains(at_px)) return;
  const cv::Point beam(static_cast<int>(std::lround(at_px.x())), static_cast<int>(std::lround(at_px.y())));
  const cv::Mat grown = cv::Mat::ones(kFaintEdge_px, kFaintEdge_px, CV_8UC1);
  cv::dilate(textured, closed_, grown);
  if (closed_.at<std::uint8_t>(beam)) return;
  region_ = cv::Mat::zeros(closed_.rows + 2, closed_.cols + 2, CV_8UC1);
  cv::Rect around;
  cv::floodFill(closed_, region_, beam, 0, &around, 0, 0, 4 | 255 << 8 | cv::FLOODFILL_MASK_ONLY);
  const cv::Rect inner({1, 1}, closed_.size());
  cv::dilate(region_(inner) == 255, closed_, grown);  // without the mask's border, which is 1
  around = (around + cv::Size(2 * kFaintEdge_px, 2 * kFaintEdge_px) - cv::Point(kFaintEdge_px, kFaintEdge_px)) &
           cv::Rect({0, 0}, closed_.size());
  const Eigen::Vector2f beam_ray = (met_C.head<2>() / met_C.z()).cast<float>();
  const Eigen::Vector2f first_ray = geometry_.point(0, 0, 1.0).head<2>().cast<float>();
  const Eigen::Vector2f step = (geometry_.point(1, 1, 1.0) - geometry_.point(0, 0, 1.0)).head<2>().cast<float>();
  const auto met_px = static_cast<float>(geometry_.disparity(met_C.z()));
  for (int v = around.y; v < around.br().y; ++v) {
    auto* left_px = met_left_px_.ptr<float>(v);
    const std::uint8_t *is_textured = textured.ptr(v), *is_surface = closed_.ptr(v);
    auto* kept_px = kept_px_.ptr<float>(v);
    const float *best = evidence.best_px.ptr<float>(v), *repeated = evidence.repeated_px.ptr<float>(v);
    for (int u = around.x; u < around.br().x; ++u) {
      if (!is_surface[u] || is_textured[u]) continue;
      const float off = (first_ray + step.cwiseProduct(Eigen::Vector2f(u, v)) - beam_ray).norm();
      const float clear_px = met_px * (1.0f + kSteepest * off) + kNoise_px;
      const double match_px = correction.correct(std::isnan(best[u]) ? repeated[u] : best[u]);
      if (match_px > clear_px + kOtherSurface_px) continue;
      left_px[u] = std::min(left_px[u], clear_px);
      kept_px[u] = std::min(kept_px[u], clear_px);
    }
  }
}

void ClearRays::keepSeen() { cv::max(met_left_px_, kept_px_, met_left_px_); }

/// The right camera's ray meets the nearest match there.
void ClearRays::lookAlong(int v, const DisparityEvidence& evidence, const std::uint8_t* textured,
                          const ScaleCorrection& correction) {
  const int width = met_left_px_.cols;
  const float *best = evidence.best_px.ptr<float>(v), *repeated = evidence.repeated_px.ptr<float>(v);
  const std::uint8_t *competitor = evidence.competitor_nearest.ptr(v), *flags = evidence.flags.ptr(v);
  auto *left = met_left_px_.ptr<float>(v), *right = met_right_px_.ptr<float>(v);
  const double principal_difference_px = geometry_.principalPointDifference();
  std::fill_n(right, width, -kUnknown_px);
  for (int u = 0; u < width; ++u) {
    left[u] = kUnknown_px;
    const bool is_repeated = std::isnan(best[u]);
    const float match_px = is_repeated ? repeated[u] : best[u];
    if (std::isnan(match_px)) continue;
    const bool has_nearer = is_repeated && (flags[u] & kCompetitor) != 0;
    const float nearest_px = has_nearer ? std::max(match_px, static_cast<float>(competitor[u] + first_px_)) : match_px;
    const float met_px = textured[u] ? static_cast<float>(correction.correct(nearest_px)) + kNoise_px : kUnknown_px;
    left[u] = met_px;
    const double at_right = u - match_px - principal_difference_px;
    if (!(at_right > -0.5)) continue;
    const int u_right = static_cast<int>(at_right + 0.5);
    if (u_right < width) right[u_right] = std::max(right[u_right], met_px);
  }
  std::replace(right, right + width, -kUnknown_px, kUnknown_px);
}

/// An end is the nearest of the matches in a strip beside the run as wide as an edge's. The right image must be without
/// texture, too, for such a strip inside the run, at that end's disparity: a run that is smeared in both images, or
/// ends elsewhere, is not a surface. A run that reaches the image's side has one end.
void ClearRays::clearTexturelessRuns(int v, const DisparityEvidence& evidence, const std::uint8_t* left,
                                     const std::uint8_t* right) {
  const int width = met_left_px_.cols;
  auto* met_px = met_left_px_.ptr<float>(v);
  const float *best = evidence.best_px.ptr<float>(v), *repeated = evidence.repeated_px.ptr<float>(v);
  /// @param beside first pixel of the strip outside.  @param inside first pixel of the strip in the run.
  const auto endOf = [&](int beside, int inside, int strip) {
    int matches = 0, nearest = -1;
    for (int u = std::max(0, beside); u < std::min(beside + kEdgeWidth_px, width); ++u) {
      if (!left[u] || !(met_px[u] < kUnknown_px)) continue;
      if (nearest < 0 || met_px[u] > met_px[nearest]) nearest = u;
      ++matches;
    }
    if (matches < kEndMatches) return kUnknown_px;
    const float match_px = std::isnan(best[nearest]) ? repeated[nearest] : best[nearest];
    const int shift = static_cast<int>(std::lround(match_px + geometry_.principalPointDifference()));
    int textured = 0;
    for (int u = inside - shift; u < inside - shift + strip; ++u) textured += u < 0 || u >= width || right[u];
    return 4 * textured <= strip ? met_px[nearest] : kUnknown_px;
  };
  for (int u = 0, end = 0; u < width; u = end) {
    end = u + 1;
    if (left[u]) continue;
    while (end < width && !left[end]) ++end;
    if (u == 0 || end == width) continue;
    const int strip = end - u > 2 * kEdgeWidth_px ? kEdgeWidth_px : 0;  // shorter gaps are of noise
    const float one_px = endOf(u - kEdgeWidth_px, u, strip), other_px = endOf(end, end - strip, strip);
    std::fill(met_px + u, met_px + end, std::max(one_px, other_px));
    if (strip > 0) std::fill(kept_px_.ptr<float>(v) + u, kept_px_.ptr<float>(v) + end, kUnknown_px);
  }
}

}  // namespace flight_corridor
