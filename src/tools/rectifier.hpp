#pragma once

#include <opencv2/core/mat.hpp>

#include "tools/stereo_cameras.hpp"

namespace flight_corridor::tools {

/// Rectifies raw images: each pixel of the rectified image is looked up where the lens brings its ray.
/// Model: x_raw = lens(R^-1 K_P^-1 x_rectified; K, D), K_P: P without its last column. Source: OpenCV, calib3d.
class Rectifier {
 public:
  /// @throws std::invalid_argument as requireRectifiable.
  explicit Rectifier(const StereoCameras& cameras);

  /// @param raw of the cameras' size, any type that cv::remap accepts.
  /// @return the rectified image; black where the raw image does not reach.
  /// @throws std::invalid_argument naming the size when it is another.
  cv::Mat left(const cv::Mat& raw) const { return remap(raw, left_); }
  cv::Mat right(const cv::Mat& raw) const { return remap(raw, right_); }

 private:
  struct Maps {
    cv::Mat whole_px, fraction;
  };
  static Maps mapsOf(const sensor_msgs::CameraInfo& camera);
  static cv::Mat remap(const cv::Mat& raw, const Maps& maps);

  Maps left_, right_;
};

}  // namespace flight_corridor::tools
