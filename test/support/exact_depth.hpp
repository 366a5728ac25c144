#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "sim/world.hpp"

namespace flight_corridor::test_support {

/// Pixels that a solid can cover: around its box's corners; the whole image where one is not ahead.
inline cv::Rect pixelsOf(const sim::Primitive& solid, const StereoGeometry& geometry, const Eigen::Isometry3d& T_C_O) {
  const cv::Rect image({0, 0}, geometry.size());
  Eigen::Array2d low = Eigen::Array2d::Constant(kInfinity), high = -low;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d signs(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const Eigen::Vector3d p_C = T_C_O * solid.half_m.cwiseProduct(signs);
    if (p_C.z() < 0.1) return image;
    low = low.min(geometry.project(p_C).array());
    high = high.max(geometry.project(p_C).array());
  }
  const Eigen::Array2i from = low.max(0.0).min(1e4).cast<int>(), to = high.max(-1.0).min(1e4).cast<int>() + 1;
  return cv::Rect(cv::Point(from.x(), from.y()), cv::Point(to.x(), to.y())) & image;
}

/// Depth image of solids at the pixels' centres, as a perfect camera would measure it; NaN = sky.
inline cv::Mat exactDepth(const std::vector<sim::Primitive>& world, const StereoGeometry& geometry,
                          const Eigen::Isometry3d& T_W_C) {
  cv::Mat depth_m(geometry.size(), CV_32FC1, cv::Scalar(kNaN));
  for (const sim::Primitive& solid : world) {
    const Eigen::Isometry3d T_O_C = solid.T_W_O.inverse() * T_W_C;
    const cv::Rect pixels = pixelsOf(solid, geometry, T_O_C.inverse());
    const Eigen::Vector3f origin_O = T_O_C.translation().cast<float>();
    for (int v = pixels.y; v < pixels.y + pixels.height; ++v) {
      for (int u = pixels.x; u < pixels.x + pixels.width; ++u) {
        const Eigen::Vector3f ray_O = (T_O_C.linear() * geometry.point(u, v, 1.0)).cast<float>();
        const auto met = sim::intersect(solid, origin_O, ray_O);
        float& nearest_m = depth_m.at<float>(v, u);
        if (met && !(nearest_m <= met->t)) nearest_m = met->t;  // the ray's z is 1: its parameter is the depth
      }
    }
  }
  return depth_m;
}

}  // namespace flight_corridor::test_support
