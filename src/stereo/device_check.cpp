#include "stereo/device_check.hpp"

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>

#include "stereo/match_into.hpp"

namespace flight_corridor {

namespace {

/// Tiles of noise, of no texture, of texture that repeats, and of texture, at every disparity from the first row to the
/// last, half pixels between: the matcher finds all that it can tell apart.
StereoFrame samplePair(const MatcherSize& size) {
  constexpr int kTile = 128, kTileRows = 16, kPeriod = 24;  // half pixels
  const int before_px = std::max(0, -size.min_disparity_px);
  const int behind_px = std::max(0, size.min_disparity_px + size.num_disparities);
  cv::Mat texture(size.height_px, 2 * (before_px + size.width_px + behind_px), CV_8UC1);
  cv::RNG random(1);
  random.fill(texture, cv::RNG::UNIFORM, 0, 250);
  const auto surface = [&](int v, int i) -> int {
    const int kind = (v / kTileRows + i / kTile) % 4;
    if (kind == 0) return random.uniform(0, 250);
    if (kind == 1) return 100;
    const std::uint8_t* const grey = texture.ptr(v, kind == 2 ? i % kPeriod : i);
    return (grey[0] + grey[1]) / 2;
  };
  const cv::Size size_px(size.width_px, size.height_px);
  StereoFrame pair{0.0, cv::Mat(size_px, CV_8UC1), cv::Mat(size_px, CV_8UC1)};
  for (int v = 0; v < size_px.height; ++v) {
    const int shift = 2 * size.min_disparity_px + v * 2 * size.num_disparities / size_px.height;
    for (int u = 0; u < size_px.width; ++u) {
      const int i = 2 * (before_px + u);
      pair.left.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(surface(v, i) + random.uniform(0, 3));
      pair.right.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(surface(v, i + shift) + random.uniform(0, 3));
    }
  }
  return pair;
}

bool same(DisparityEvidence one, DisparityEvidence other) {
  constexpr double kNoDisparity_px = -1e6;
  using Evidence = DisparityEvidence;
  for (const auto map : {&Evidence::best_px, &Evidence::repeated_px, &Evidence::flags, &Evidence::set,
                         &Evidence::competitor_farthest, &Evidence::competitor_nearest}) {
    for (cv::Mat* const floats : {&(one.*map), &(other.*map)}) {
      if (floats->depth() == CV_32F) cv::patchNaNs(*floats, kNoDisparity_px);  // NaNs differ in bits
    }
    if (cv::norm(one.*map, other.*map, cv::NORM_INF) != 0.0) return false;
  }
  return true;
}

}  // namespace

void requireSameMatches(DeviceMatcher& device, SemiGlobalMatcher& cpu, const MatcherSize& size) {
  const StereoFrame pair = samplePair(size);
  const auto matched_by = [&](auto& matcher) {
    DisparityEvidence evidence;
    for (cv::Mat* map : {&evidence.competitor_farthest, &evidence.competitor_nearest}) {
      *map = cv::Mat::zeros(pair.left.size(), CV_8UC1);  // not written where there is none
    }
    matchInto(evidence, matcher, pair, size.num_disparities);
    return evidence;
  };
  if (!same(matched_by(device), matched_by(cpu)))
    throw DeviceError("OpenCL: the device finds other matches than the CPU");
}

}  // namespace flight_corridor
