#include "flight_corridor/stereo/disparity_estimator.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "flight_corridor/stereo/matching_rules.hpp"
#include "flight_corridor/stereo/search_range.hpp"

namespace flight_corridor {

namespace {

std::string describe(const cv::Size& size) { return std::to_string(size.width) + " x " + std::to_string(size.height); }

void throwIfUnfit(const cv::Mat& image, const std::string& side, const cv::Size& size) {
  if (image.size() == size && image.type() == CV_8UC1) return;
  throw std::invalid_argument("stereo: the " + side + " image is " + describe(image.size()) + " of OpenCV's type " +
                              std::to_string(image.type()) + ", not " + describe(size) + " of type 0, grey of 8 bits");
}

GreyImage viewOf(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step)};
}

MatcherSize matcherSize(const StereoGeometry& geometry, int num_disparities) {
  return {geometry.size().width, geometry.size().height, smallestDisparity(geometry), num_disparities,
          static_cast<float>(geometry.principalPointDifference())};
}

const StereoConfig& valid(const StereoConfig& config, const StereoGeometry& geometry) {
  throwIfBroken(check(config));
  if (geometry.size().width <= config.num_disparities_px) {
    throw std::invalid_argument("stereo/num_disparities_px: below the image's width (" +
                                std::to_string(config.num_disparities_px) + ", " +
                                std::to_string(geometry.size().width) + ")");
  }
  return config;
}

template <class Matcher>
void matchBy(Matcher& matcher, const StereoFrame& frame, int num_disparities, DisparityEvidence& out) {
  const cv::Size size = frame.left.size();
  for (cv::Mat* map : {&out.best_px, &out.repeated_px}) map->create(size, CV_32FC1);
  for (cv::Mat* map : {&out.flags, &out.competitor_farthest, &out.competitor_nearest}) map->create(size, CV_8UC1);
  out.set.create(size, CV_8UC(storedDisparities(num_disparities) / 8));
  matcher.match(viewOf(frame.left), viewOf(frame.right),
                {out.best_px.ptr<float>(), out.repeated_px.ptr<float>(), out.competitor_farthest.data,
                 out.competitor_nearest.data, out.flags.data, reinterpret_cast<std::uint64_t*>(out.set.data)});
}

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

/// @throws DeviceError unless both find the same: compilers of kernels make mistakes.
void requireSameMatches(DeviceMatcher& device, SemiGlobalMatcher& cpu, const MatcherSize& size) {
  const StereoFrame pair = samplePair(size);
  const auto matched_by = [&](auto& matcher) {
    DisparityEvidence evidence;
    for (cv::Mat* map : {&evidence.competitor_farthest, &evidence.competitor_nearest}) {
      *map = cv::Mat::zeros(pair.left.size(), CV_8UC1);  // not written where there is none
    }
    matchBy(matcher, pair, size.num_disparities, evidence);
    return evidence;
  };
  if (!same(matched_by(device), matched_by(cpu)))
    throw DeviceError("OpenCL: the device finds other matches than the CPU");
}

}  // namespace

Violations check(const StereoConfig& config) {
  Rules rules("stereo");
  rules.require(0 < config.num_disparities_px && config.num_disparities_px <= kLargestDisparities &&
                    config.num_disparities_px % 32 == 0,
                "num_disparities_px", "a multiple of 32, up to " + std::to_string(kLargestDisparities),
                config.num_disparities_px);
  rules.require(0.0 <= config.min_matched_fraction && config.min_matched_fraction <= 1.0, "min_matched_fraction",
                "0 to 1", config.min_matched_fraction);
  const bool is_known = config.device == "cpu" || config.device == "gpu" || config.device == "auto";
  rules.require(is_known, "device", "cpu, gpu or auto", config.device);
  return rules.broken();
}

void requireDevice(const StereoConfig& config, const DeviceMatcherFactory& make_device_matcher) {
  if (config.device != "gpu") return;
  const double width_px = config.num_disparities_px + 64.0, height_px = 64.0;
  const StereoGeometry geometry(
      {cv::Size2d(width_px, height_px), width_px, width_px, width_px / 2, height_px / 2, width_px / 2, 0.1});
  const std::string failure = DisparityEstimator(config, geometry, 0.0, make_device_matcher).device().failure;
  if (failure.empty()) return;
  throw std::invalid_argument("stereo/device: gpu: " + failure + ". Choose cpu or auto without one");
}

DisparityEstimator::DisparityEstimator(const StereoConfig& config, const StereoGeometry& geometry,
                                       double smallest_obstacle_m, const DeviceMatcherFactory& make_device_matcher)
    : num_disparities_(valid(config, geometry).num_disparities_px),
      geometry_(geometry),
      workers_(std::max(1, cv::getNumThreads())),
      matcher_(matcherSize(geometry, num_disparities_), workers_),
      patches_(geometry, smallest_obstacle_m, workers_) {
  if (config.device == "cpu") return;
  try {
    const MatcherSize size = matcherSize(geometry, num_disparities_);
    std::unique_ptr<DeviceMatcher> matcher = make_device_matcher(size);
    if (!matcher && config.device == "auto") return;
    if (!matcher) throw DeviceError("OpenCL finds no GPU: install its driver with OpenCL (clinfo lists it)");
    requireSameMatches(*matcher, matcher_, size);
    device_.name = matcher->name();
    device_matcher_ = std::move(matcher);
  } catch (const DeviceError& error) {
    device_.failure = error.what();
  }
}

void DisparityEstimator::estimate(const StereoFrame& frame, Disparity& out) {
  match(frame, out);
  if (!covered_.empty()) {
    for (cv::Mat* map : {&out.best_px, &out.repeated_px}) map->setTo(kNaN, covered_);
  }
  out.matched_fraction = patches_.keep(out.best_px, out.repeated_px) / static_cast<double>(out.best_px.total());
}

void DisparityEstimator::match(const StereoFrame& frame, DisparityEvidence& out) {
  throwIfUnfit(frame.left, "left", geometry_.size());
  throwIfUnfit(frame.right, "right", geometry_.size());
  if (device_matcher_) {
    try {
      return matchBy(*device_matcher_, frame, num_disparities_, out);
    } catch (const DeviceError& error) {
      device_matcher_.reset();  // one that failed is not to be trusted
      device_ = {MatchingDevice().name, error.what()};
    }
  }
  matchBy(matcher_, frame, num_disparities_, out);
}

double DisparityEstimator::nearestDepth() const {
  return geometry_.depth(firstDisparity(geometry_) + num_disparities_ - 1);
}

}  // namespace flight_corridor
