#include "flight_corridor/stereo/disparity_estimator.hpp"

#include <algorithm>
#include <memory>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "flight_corridor/stereo/search_range.hpp"
#include "stereo/device_check.hpp"
#include "stereo/match_into.hpp"

namespace flight_corridor {

namespace {

std::string describe(const cv::Size& size) { return std::to_string(size.width) + " x " + std::to_string(size.height); }

void throwIfUnfit(const cv::Mat& image, const std::string& side, const cv::Size& size) {
  if (image.size() == size && image.type() == CV_8UC1) return;
  throw std::invalid_argument("stereo: the " + side + " image is " + describe(image.size()) + " of OpenCV's type " +
                              std::to_string(image.type()) + ", not " + describe(size) + " of type 0, grey of 8 bits");
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

}  // namespace

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
    auto matcher = make_device_matcher ? make_device_matcher(size) : nullptr;
    if (!matcher && config.device == "auto") return;
    if (!make_device_matcher) throw DeviceError("this program matches on the CPU only");
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
      return matchInto(out, *device_matcher_, frame, num_disparities_);
    } catch (const DeviceError& error) {
      device_matcher_.reset();  // one that failed is not to be trusted
      device_ = {MatchingDevice().name, error.what()};
    }
  }
  matchInto(out, matcher_, frame, num_disparities_);
}

double DisparityEstimator::nearestDepth() const {
  return geometry_.depth(firstDisparity(geometry_) + num_disparities_ - 1);
}

}  // namespace flight_corridor
