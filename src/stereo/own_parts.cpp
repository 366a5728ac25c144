#include "flight_corridor/stereo/own_parts.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "flight_corridor/stereo/matching_rules.hpp"

namespace flight_corridor {

namespace {

constexpr int kBesidePart_px = kCensusReach_px + kWindowReach_px;  // a match's windows; texture's reach 6
constexpr int kAbovePart_px = 2;                                   // their rows, and texture's

std::string inPixels(const cv::Size& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height) + " px";
}

}  // namespace

cv::Mat coveredPixels(const OwnParts& parts, const cv::Size& image_px) {
  if (parts.mask.empty()) return {};
  const auto refuse = [&](const std::string& why) { throw std::invalid_argument("stereo/mask " + parts.name + why); };
  if (parts.mask.type() != CV_8UC1) refuse(" is of OpenCV's type " + std::to_string(parts.mask.type()) + ", not of 0");
  if (parts.mask.size() != image_px) {
    refuse(" is " + inPixels(parts.mask.size()) + ", but the left image is " + inPixels(image_px));
  }
  cv::Mat covered;
  cv::dilate(parts.mask == 0, covered, cv::Mat::ones(2 * kAbovePart_px + 1, 2 * kBesidePart_px + 1, CV_8UC1));
  if (cv::countNonZero(covered) == image_px.area()) refuse(" covers the whole image: black is covered, white is view");
  return covered;
}

}  // namespace flight_corridor
