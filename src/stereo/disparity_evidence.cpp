#include "flight_corridor/stereo/disparity_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "flight_corridor/stereo/cost_minima.hpp"

namespace flight_corridor {

namespace {

constexpr int kBelowZero_px = 2;                       // searched below zero: far surfaces of a rig with an offset
constexpr float kLargestOffset_px = 1.5f;              // of such a rig; what is still farther is a wrong match
constexpr float kSmallestDisparity_px = 1.0f / 16.0f;  // "as far as can be told"

int minDisparity(const StereoGeometry& geometry) {
  return static_cast<int>(std::floor(geometry.principalPointDifference())) - kBelowZero_px;
}

GreyImage viewOf(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step)};
}

/// A match far below zero is a wrong one; a little below, of a rig with an offset.
float plausible(float disparity_px) {
  if (!(disparity_px >= -kLargestOffset_px)) return std::numeric_limits<float>::quiet_NaN();
  return std::max(disparity_px, kSmallestDisparity_px);
}

}  // namespace

EvidenceMatcher::EvidenceMatcher(const StereoGeometry& geometry, int num_disparities, int threads)
    : size_(geometry.size()),
      first_px_(minDisparity(geometry) - geometry.principalPointDifference()),
      set_bytes_(storedDisparities(num_disparities) / 8),
      matcher_({geometry.size().width, geometry.size().height, minDisparity(geometry), num_disparities}, threads) {
  for (cv::Mat* index : {&farthest_, &nearest_, &competitor_farthest_, &competitor_nearest_}) {
    index->create(size_, CV_8UC1);
  }
}

void EvidenceMatcher::create(DisparityEvidence& out) {
  for (cv::Mat* map :
       {&out.best_px, &out.farthest_px, &out.nearest_px, &out.competitor_farthest_px, &out.competitor_nearest_px}) {
    map->create(size_, CV_32FC1);
  }
  out.flags.create(size_, CV_8UC1);
  out.set.create(size_, CV_8UC(set_bytes_));
}

void EvidenceMatcher::match(const StereoFrame& frame, DisparityEvidence& out) {
  create(out);
  matcher_.match(viewOf(frame.left), viewOf(frame.right),
                 {out.best_px.ptr<float>(), farthest_.data, nearest_.data, competitor_farthest_.data,
                  competitor_nearest_.data, out.flags.data, reinterpret_cast<std::uint64_t*>(out.set.data)});
  toPixels(out);
}

void EvidenceMatcher::toPixels(DisparityEvidence& out) const {
  const float first_px = static_cast<float>(first_px_), none = std::numeric_limits<float>::quiet_NaN();
  const std::uint8_t *flags = out.flags.data, *farthest = farthest_.data, *nearest = nearest_.data;
  const std::uint8_t *competitor_farthest = competitor_farthest_.data, *competitor_nearest = competitor_nearest_.data;
  float *best_px = out.best_px.ptr<float>(), *farthest_px = out.farthest_px.ptr<float>();
  float *nearest_px = out.nearest_px.ptr<float>(), *competitor_farthest_px = out.competitor_farthest_px.ptr<float>();
  float* competitor_nearest_px = out.competitor_nearest_px.ptr<float>();
  for (int i = 0; i < size_.area(); ++i) {
    best_px[i] = plausible(best_px[i] + first_px);
    farthest_px[i] = static_cast<float>(farthest[i]) + (first_px - kBoundSlack_px);
    nearest_px[i] = static_cast<float>(nearest[i]) + (first_px + kBoundSlack_px);
    const bool competitor = flags[i] & kCompetitor;
    competitor_farthest_px[i] = competitor ? static_cast<float>(competitor_farthest[i]) + first_px : none;
    competitor_nearest_px[i] = competitor ? static_cast<float>(competitor_nearest[i]) + first_px : none;
  }
}

}  // namespace flight_corridor
