#pragma once

#include <opencv2/core/mat.hpp>

#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor {

/// Where the rays of an image's pixels enter a box and where they leave it, as the disparities that a surface there
/// would have. One object, one thread.
class BoxView {
 public:
  explicit BoxView(const StereoGeometry& geometry) : geometry_(geometry) {}

  /// Done again only where the box differs from the last one.
  /// @param nearest_m depth from which on rays count.
  void look(const Box& box_C, double nearest_m);

  /// CV_32FC1 of geometry.size() [px]: the largest disparity in the box, the smallest; -inf where a ray misses it.
  const cv::Mat& entry() const { return entry_px_; }
  const cv::Mat& exit() const { return exit_px_; }

 private:
  StereoGeometry geometry_;
  Eigen::Isometry3d T_C_F_ = Eigen::Isometry3d::Identity();
  Eigen::Vector3d size_m_{0, 0, 0};
  double nearest_m_ = kNaN;
  cv::Mat entry_px_, exit_px_;
};

}  // namespace flight_corridor
