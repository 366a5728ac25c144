#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>

#include "flight_corridor/stereo/disparity_evidence.hpp"
#include "flight_corridor/stereo/matching_rules.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// @param matcher SemiGlobalMatcher or DeviceMatcher, for pairs of that size.
/// @param out its maps are created.
template <class Matcher>
void matchInto(DisparityEvidence& out, Matcher& matcher, const StereoFrame& frame, int num_disparities) {
  const cv::Size size = frame.left.size();
  for (cv::Mat* map : {&out.best_px, &out.repeated_px}) map->create(size, CV_32FC1);
  for (cv::Mat* map : {&out.flags, &out.competitor_farthest, &out.competitor_nearest}) map->create(size, CV_8UC1);
  out.set.create(size, CV_8UC(storedDisparities(num_disparities) / 8));
  const auto view = [](const cv::Mat& image) {
    return GreyImage{image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step)};
  };
  matcher.match(view(frame.left), view(frame.right),
                {out.best_px.ptr<float>(), out.repeated_px.ptr<float>(), out.competitor_farthest.data,
                 out.competitor_nearest.data, out.flags.data, reinterpret_cast<std::uint64_t*>(out.set.data)});
}

}  // namespace flight_corridor
