#include "sim/shutter.hpp"

#include <opencv2/core.hpp>

#include "sim/render.hpp"

namespace flight_corridor::sim {
namespace {

constexpr int kMoments = 5;  // of an exposure: 4 px of motion blur are sampled less than a pixel apart

cv::Mat lightAt(const Scene& scene, double time_s, CameraOfRig camera_of_rig) {
  const std::vector<Primitive> world = visibleAt(scene.world, time_s);
  const Eigen::Isometry3d T_W_B = scene.flight.T_W_B(time_s);
  const Camera camera = camera_of_rig(scene.rig, T_W_B);
  Light light = scene.light;
  if (scene.projector) {
    light.dots = ProjectedDots{*scene.projector, (T_W_B * scene.rig.T_B_C * scene.projector->T_C_P).inverse()};
  }
  cv::Mat radiance = render(world, camera, light).radiance;
  if (scene.sun) addGlare(*scene.sun, world, camera, radiance);
  return radiance;
}

}  // namespace

cv::Mat collectLight(const Scene& scene, double time_s, CameraOfRig camera_of_rig) {
  if (scene.rig.exposure_s == 0.0) return lightAt(scene, time_s, camera_of_rig);
  cv::Mat mean(scene.rig.calibration.size_px, CV_32FC1, cv::Scalar(0.0));
  for (int i = 0; i < kMoments; ++i) {
    const double from_middle_s = scene.rig.exposure_s * ((i + 0.5) / kMoments - 0.5);
    mean += lightAt(scene, time_s + from_middle_s, camera_of_rig) / kMoments;
  }
  return mean;
}

}  // namespace flight_corridor::sim
