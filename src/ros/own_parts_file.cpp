#include "ros/own_parts_file.hpp"

#include <ros/console.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>

#include "ros/image_scale.hpp"

namespace flight_corridor_ros {

namespace {

constexpr int kBright = 128;          // of 255; between are a JPEG's errors, and smooth edges
constexpr double kMostCovered = 0.5;  // of the view: more is hardly meant

/// Empty if it is no image.
cv::Mat readGrey(const std::string& path) try {
  return cv::imread(path, cv::IMREAD_GRAYSCALE);
} catch (const cv::Exception&) {  // too large
  return {};
}

}  // namespace

flight_corridor::OwnParts readOwnParts(const std::string& path, double scale) {
  if (path.empty()) return {};
  const cv::Mat grey = readGrey(path);
  if (grey.empty()) throw std::invalid_argument("stereo/mask: no readable image (" + path + ")");
  const cv::Mat view = grey >= kBright;
  const double covered = 1.0 - cv::countNonZero(view) / static_cast<double>(view.total());
  if (covered > kMostCovered) {
    ROS_WARN("stereo/mask %s covers %.0f %% of the left image: black is covered, white is view", path.c_str(),
             100.0 * covered);
  }
  std::ostringstream name;
  name << path;
  if (scale != 1.0) name << ", at ros/scale " << scale << ",";
  return {scaled(view, scale) == 255, name.str()};
}

}  // namespace flight_corridor_ros
