#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "sim/light.hpp"
#include "sim/world.hpp"

namespace flight_corridor::sim {

/// A pinhole without distortion. C is optical: z forward, x right, y down; pixel (0,0) has its centre at (0.0, 0.0).
struct Camera {
  cv::Size size_px;
  double fx_px;
  double fy_px;
  double cx_px;
  double cy_px;
  Eigen::Isometry3d T_W_C;
};

struct Rendering {
  cv::Mat radiance;  ///< CV_32FC1, 1 = white in the sun.
  cv::Mat depth_m;   ///< CV_32FC1, along z of C at the pixels' centres; NaN = sky.
};

/// Casts rays into the world: textured, Lambert-shaded surfaces before the sky, anti-aliased at outlines. A mirror adds
/// what it reflects; its depth is its own. Primitives that the camera does not see (Material::camera_sees) are left
/// out.
Rendering render(const std::vector<Primitive>& primitives, const Camera& camera, const Light& light = {});

}  // namespace flight_corridor::sim
