#include "sim/glare.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

namespace flight_corridor::sim {
namespace {

constexpr double kSunRadius_rad = 0.0047;

bool hides(const Primitive& primitive, const Eigen::Vector3d& eye_W, const Eigen::Vector3d& to_sun_W) {
  const Eigen::Isometry3d T_O_W = primitive.T_W_O.inverse();
  return primitive.material.camera_sees &&
         intersect(primitive, (T_O_W * eye_W).cast<float>(), (T_O_W.linear() * to_sun_W).cast<float>());
}

}  // namespace

void addGlare(const Sun& sun, const std::vector<Primitive>& primitives, const Camera& camera, cv::Mat& radiance) {
  const Eigen::Vector3d eye_W = camera.T_W_C.translation();
  for (const Primitive& primitive : primitives) {
    if (hides(primitive, eye_W, sun.to_sun_W)) return;
  }
  const Eigen::Vector3d to_sun_C = camera.T_W_C.linear().transpose() * sun.to_sun_W;
  for (int v = 0; v < radiance.rows; ++v) {
    for (int u = 0; u < radiance.cols; ++u) {
      const Eigen::Vector3d ray_C((u - camera.cx_px) / camera.fx_px, (v - camera.cy_px) / camera.fy_px, 1.0);
      const double angle_rad = std::atan2(ray_C.cross(to_sun_C).norm(), ray_C.dot(to_sun_C));
      const double relative = sun.saturated_rad / std::max(angle_rad, kSunRadius_rad);
      radiance.at<float>(v, u) += static_cast<float>(relative * relative);
    }
  }
}

}  // namespace flight_corridor::sim
