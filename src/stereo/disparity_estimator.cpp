#include "flight_corridor/stereo/disparity_estimator.hpp"

#include <algorithm>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>

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

DisparityEstimator::DisparityEstimator(const StereoConfig& config, const StereoGeometry& geometry,
                                       double smallest_obstacle_m, const DeviceMatcherFactory& make_device_matcher)
    : num_disparities_(valid(config, geometry).num_disparities_px),
      geometry_(geometry),
      workers_(std::max(1, cv::getNumThreads())),
      matcher_(matcherSize(geometry, num_disparities_), workers_),
      patches_(geometry, smallest_obstacle_m, workers_) {
  if (config.device == "cpu") return;
  try {
    device_matcher_ = make_device_matcher(matcherSize(geometry, num_disparities_));
    if (device_matcher_) device_.name = device_matcher_->name();
    if (!device_matcher_ && config.device == "gpu") device_.failure = "there is no GPU";
  } catch (const DeviceError& error) {
    device_.failure = error.what();
  }
}

void DisparityEstimator::estimate(const StereoFrame& frame, Disparity& out) {
  match(frame, out);
  out.matched_fraction = patches_.keep(out.best_px, out.repeated_px) / static_cast<double>(out.best_px.total());
}

void DisparityEstimator::match(const StereoFrame& frame, DisparityEvidence& out) {
  const cv::Size size = geometry_.size();
  throwIfUnfit(frame.left, "left", size);
  throwIfUnfit(frame.right, "right", size);
  for (cv::Mat* map : {&out.best_px, &out.repeated_px}) map->create(size, CV_32FC1);
  for (cv::Mat* map : {&out.flags, &out.competitor_farthest, &out.competitor_nearest}) map->create(size, CV_8UC1);
  out.set.create(size, CV_8UC(storedDisparities(num_disparities_) / 8));
  const GreyImage left = viewOf(frame.left), right = viewOf(frame.right);
  const MatchPlanes planes{out.best_px.ptr<float>(),
                           out.repeated_px.ptr<float>(),
                           out.competitor_farthest.data,
                           out.competitor_nearest.data,
                           out.flags.data,
                           reinterpret_cast<std::uint64_t*>(out.set.data)};
  if (device_matcher_) {
    try {
      return device_matcher_->match(left, right, planes);
    } catch (const DeviceError& error) {
      device_matcher_.reset();  // one that failed is not to be trusted
      device_ = {MatchingDevice().name, error.what()};
    }
  }
  matcher_.match(left, right, planes);
}

double DisparityEstimator::nearestDepth() const {
  return geometry_.depth(firstDisparity(geometry_) + num_disparities_ - 1);
}

}  // namespace flight_corridor
