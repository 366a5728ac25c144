#pragma once

#include <Eigen/Core>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor {

constexpr double kNearestDrawn_m = 0.1;  // shapes that reach behind the camera are clipped here

/// A picture as CV_8UC3 (BGR), its own copy.
inline void toColour(const cv::Mat& picture, cv::Mat& out) {
  if (picture.channels() == 1) {
    cv::cvtColor(picture, out, cv::COLOR_GRAY2BGR);
  } else {
    picture.copyTo(out);
  }
}

/// Text with a dark rim, legible on any picture.  @param at left end of its base line.
inline void write(cv::Mat& image, const std::string& text, cv::Point at, double scale, const cv::Scalar& colour) {
  cv::putText(image, text, at, cv::FONT_HERSHEY_DUPLEX, scale, {0, 0, 0}, 3, cv::LINE_AA);
  cv::putText(image, text, at, cv::FONT_HERSHEY_DUPLEX, scale, colour, 1, cv::LINE_AA);
}

/// Draws shapes given in C on the left image.
class Canvas {
 public:
  Canvas(const StereoGeometry& geometry, cv::Mat& image) : geometry_(geometry), image_(image) {}

  void line(Eigen::Vector3d from_C, Eigen::Vector3d to_C, const cv::Scalar& colour) {
    if (from_C.z() > to_C.z()) std::swap(from_C, to_C);
    if (to_C.z() <= kNearestDrawn_m) return;
    if (from_C.z() < kNearestDrawn_m) {
      from_C += (to_C - from_C) * ((kNearestDrawn_m - from_C.z()) / (to_C.z() - from_C.z()));
    }
    cv::line(image_, pixel(from_C), pixel(to_C), colour, 1, cv::LINE_AA);
  }

  void fill(const std::vector<Eigen::Vector3d>& polygon_C, const cv::Scalar& colour, double opacity) {
    const std::vector<cv::Point> polygon = outline(polygon_C);
    if (polygon.empty()) return;
    cv::Mat painted = image_.clone();
    cv::fillConvexPoly(painted, polygon, colour, cv::LINE_AA);
    cv::addWeighted(painted, opacity, image_, 1.0 - opacity, 0.0, image_);
    cv::polylines(image_, polygon, true, colour, 2, cv::LINE_AA);
  }

  /// Whether a point is before the camera: what has a pixel.
  static bool shows(const Eigen::Vector3d& p_C) { return p_C.allFinite() && p_C.z() > kNearestDrawn_m; }

  /// Its pixels; none when it reaches behind the camera.
  std::vector<cv::Point> outline(const std::vector<Eigen::Vector3d>& polygon_C) const {
    std::vector<cv::Point> pixels;
    for (const Eigen::Vector3d& p_C : polygon_C) {
      if (!shows(p_C)) return {};
      pixels.push_back(pixel(p_C));
    }
    return pixels;
  }

  /// Of a point that it shows.
  cv::Point pixel(const Eigen::Vector3d& p_C) const {
    const Eigen::Vector2d pixel = geometry_.project(p_C).cwiseMax(-10000.0).cwiseMin(10000.0);
    return {cvRound(pixel.x()), cvRound(pixel.y())};
  }

 private:
  const StereoGeometry& geometry_;
  cv::Mat& image_;
};

}  // namespace flight_corridor
