#include "ros/image_scale.hpp"

#include <boost/make_shared.hpp>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

namespace flight_corridor_ros {

namespace {

constexpr int kLargestSquare_px = 8;

int squareOf(double scale) { return static_cast<int>(std::lround(1.0 / scale)); }

double scaledCentre(double centre_px, double scale) { return scale * (centre_px + 0.5) - 0.5; }

/// The offset is rounded up: a region that begins beside the corner must not become the whole image.
void scaleRegion(sensor_msgs::RegionOfInterest& region, std::uint32_t square) {
  region.x_offset = (region.x_offset + square - 1) / square;
  region.y_offset = (region.y_offset + square - 1) / square;
  region.width /= square;
  region.height /= square;
}

}  // namespace

bool isImageScale(double scale) {
  for (int square = 1; square <= kLargestSquare_px; square *= 2) {
    if (scale * square == 1.0) return true;
  }
  return false;
}

cv::Mat scaled(const cv::Mat& image, double scale) {
  const int square = squareOf(scale);
  if (square == 1) return image;
  const cv::Size size(image.cols / square, image.rows / square);
  cv::Mat smaller;
  if (!size.empty()) cv::resize(image({{0, 0}, size * square}), smaller, size, 0.0, 0.0, cv::INTER_AREA);
  return smaller;
}

sensor_msgs::CameraInfoConstPtr scaled(const sensor_msgs::CameraInfoConstPtr& info, double scale) {
  const auto square = static_cast<std::uint32_t>(squareOf(scale));
  if (square == 1) return info;
  const auto smaller = boost::make_shared<sensor_msgs::CameraInfo>(*info);
  smaller->width /= square;
  smaller->height /= square;
  for (const std::size_t i : {0u, 1u, 4u}) smaller->K[i] *= scale;
  for (const std::size_t i : {2u, 5u}) smaller->K[i] = scaledCentre(info->K[i], scale);
  for (const std::size_t i : {0u, 1u, 3u, 5u, 7u}) smaller->P[i] *= scale;
  for (const std::size_t i : {2u, 6u}) smaller->P[i] = scaledCentre(info->P[i], scale);
  scaleRegion(smaller->roi, square);
  return smaller;
}

}  // namespace flight_corridor_ros
