#include "flight_corridor/stereo/disparity_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

#include "flight_corridor/stereo/cost_minima.hpp"
#include "flight_corridor/stereo/search_range.hpp"

namespace flight_corridor {

namespace {

constexpr int kBands = 8;  // of pixels, side by side

GreyImage viewOf(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step)};
}

std::string describe(const cv::Size& size) { return std::to_string(size.width) + " x " + std::to_string(size.height); }

void throwIfUnfit(const cv::Mat& image, const std::string& side, const cv::Size& size) {
  if (image.size() == size && image.type() == CV_8UC1) return;
  const std::string fault = image.size() == size
                                ? "is not grey of 8 bits: its OpenCV type is " + std::to_string(image.type())
                                : "is " + describe(image.size()) + ", not " + describe(size);
  throw std::invalid_argument("evidence matcher: the " + side + " image " + fault);
}

}  // namespace

EvidenceMatcher::EvidenceMatcher(const StereoGeometry& geometry, int num_disparities, int threads)
    : size_(geometry.size()),
      first_px_(smallestDisparity(geometry) - geometry.principalPointDifference()),
      set_bytes_(storedDisparities(num_disparities) / 8),
      matcher_({geometry.size().width, geometry.size().height, smallestDisparity(geometry), num_disparities}, threads) {
  for (cv::Mat* index : {&farthest_, &nearest_, &competitor_farthest_, &competitor_nearest_}) {
    index->create(size_, CV_8UC1);
  }
}

void EvidenceMatcher::create(DisparityEvidence& out) {
  for (cv::Mat* map : {&out.best_px, &out.repeated_px, &out.farthest_px, &out.nearest_px, &out.competitor_farthest_px,
                       &out.competitor_nearest_px}) {
    map->create(size_, CV_32FC1);
  }
  out.flags.create(size_, CV_8UC1);
  out.set.create(size_, CV_8UC(set_bytes_));
}

void EvidenceMatcher::match(const StereoFrame& frame, DisparityEvidence& out) {
  throwIfUnfit(frame.left, "left", size_);
  throwIfUnfit(frame.right, "right", size_);
  create(out);
  matcher_.match(viewOf(frame.left), viewOf(frame.right),
                 {out.best_px.ptr<float>(), farthest_.data, nearest_.data, competitor_farthest_.data,
                  competitor_nearest_.data, out.flags.data, reinterpret_cast<std::uint64_t*>(out.set.data)});
  const auto firstPixel = [this](int band) { return size_.height * band / kBands * size_.width; };
  matcher_.workers().run(kBands, [&](int band, int) { toPixels(firstPixel(band), firstPixel(band + 1), out); });
}

void EvidenceMatcher::toPixels(int first, int end, DisparityEvidence& out) const {
  constexpr int kMatched = kConsistent | kDistinct;
  const float first_px = static_cast<float>(first_px_), none = std::numeric_limits<float>::quiet_NaN();
  const std::uint8_t *flags = out.flags.data, *farthest = farthest_.data, *nearest = nearest_.data;
  const std::uint8_t *competitor_farthest = competitor_farthest_.data, *competitor_nearest = competitor_nearest_.data;
  float *best_px = out.best_px.ptr<float>(), *repeated_px = out.repeated_px.ptr<float>(),
        *farthest_px = out.farthest_px.ptr<float>();
  float *nearest_px = out.nearest_px.ptr<float>(), *competitor_farthest_px = out.competitor_farthest_px.ptr<float>();
  float* competitor_nearest_px = out.competitor_nearest_px.ptr<float>();
  for (int i = first; i < end; ++i) {
    farthest_px[i] = static_cast<float>(farthest[i]) + (first_px - kBoundSlack_px);
    nearest_px[i] = static_cast<float>(nearest[i]) + (first_px + kBoundSlack_px);
    const bool competitor = flags[i] & kCompetitor;
    competitor_farthest_px[i] = competitor ? static_cast<float>(competitor_farthest[i]) + first_px : none;
    competitor_nearest_px[i] = competitor ? static_cast<float>(competitor_nearest[i]) + first_px : none;
    const float match_px = (flags[i] & kMatched) == kMatched ? plausible(best_px[i] + first_px) : none;
    const bool is_repeated = competitor_farthest_px[i] < match_px;
    best_px[i] = is_repeated ? none : match_px;
    repeated_px[i] = is_repeated ? match_px : none;
  }
}

}  // namespace flight_corridor
