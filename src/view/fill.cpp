#include "flight_corridor/view/fill.hpp"

#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/ximgproc/edge_filter.hpp>

namespace flight_corridor {

namespace {

constexpr double kLambda = 500.0;      // of smoothness
constexpr double kSigmaGrey = 1.5;     // sensitivity to the image's edges
constexpr float kLeastWeight = 0.05f;  // of matches around

}  // namespace

void fillDisparity(const cv::Mat& left, const cv::Mat& matched_px, cv::Mat& filled_px) {
  const cv::Mat is_matched = matched_px == matched_px;
  cv::Mat known_px = cv::Mat::zeros(matched_px.size(), CV_32FC1), weight, weight_around;
  matched_px.copyTo(known_px, is_matched);
  is_matched.convertTo(weight, CV_32F, 1.0 / 255.0);
  const auto smoother = cv::ximgproc::createFastGlobalSmootherFilter(left, kLambda, kSigmaGrey);
  smoother->filter(known_px, filled_px);
  smoother->filter(weight, weight_around);
  cv::divide(filled_px, weight_around, filled_px);
  filled_px.setTo(std::numeric_limits<float>::quiet_NaN(), weight_around < kLeastWeight);
  matched_px.copyTo(filled_px, is_matched);
}

cv::Mat filledDisparity(const Pipeline& pipeline) {
  const cv::Mat& matched_px = pipeline.disparity().best_px;
  if (matched_px.empty()) return {pipeline.geometry().size(), CV_32FC1, cv::Scalar(kNaN)};
  cv::Mat filled_px;
  fillDisparity(pipeline.left(), matched_px, filled_px);
  return filled_px;
}

cv::Mat filledDepth(const Pipeline& pipeline) {
  cv::Mat filled_m;
  correctedDepth(filledDisparity(pipeline), pipeline.scale(), pipeline.geometry(), filled_m);
  return filled_m;
}

}  // namespace flight_corridor
