#pragma once

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "sim/render.hpp"
#include "sim/rig.hpp"
#include "sim/scene_parts.hpp"

namespace flight_corridor::test_support {

/// Coefficients k1 to k4 of an equidistant lens, as of a tracking camera with fisheyes.
inline const cv::Vec4d kFisheye(-0.0066, 0.0415, -0.0395, 0.0062);

/// The default rig's view of a world through fisheyes, rectified with the fisheyes' coefficients taken for plumb_bob's.
/// @param is_right rectified with the fisheye's model.
inline StereoFrame throughFisheyes(const std::vector<sim::Primitive>& world, std::uint64_t seed, bool is_right) {
  const sim::Rig rig = sim::defaultRig();
  const StereoCalibration& c = rig.calibration;
  const cv::Matx33d K(c.fx_px, 0, c.cx_px, 0, c.fy_px, c.cy_px, 0, 0, 1);
  const cv::Size wide_px(1600, 1200);
  const cv::Matx33d K_wide(400, 0, 799.5, 0, 400, 599.5, 0, 0, 1);
  cv::Mat raw_px, raw_u_px, raw_v_px, wide_at_px;
  if (is_right) {
    cv::fisheye::initUndistortRectifyMap(K, kFisheye, cv::Matx33d::eye(), K, c.size_px, CV_32F, raw_u_px, raw_v_px);
  } else {
    cv::initUndistortRectifyMap(K, kFisheye, cv::Matx33d::eye(), K, c.size_px, CV_32F, raw_u_px, raw_v_px);
  }
  cv::merge(std::vector<cv::Mat>{raw_u_px, raw_v_px}, raw_px);
  cv::fisheye::undistortPoints(raw_px.reshape(2, 1), wide_at_px, K, kFisheye, cv::noArray(), K_wide);
  wide_at_px = wide_at_px.reshape(2, c.size_px.height);
  Eigen::Isometry3d T_W_B = Eigen::Isometry3d::Identity();
  T_W_B.translation() = Eigen::Vector3d(0.0, 0.0, sim::kHeight_m) - rig.T_B_C.translation();
  const auto see = [&](sim::Camera camera, const sim::ImageSensor& sensor, std::uint64_t noise) {
    camera.size_px = wide_px;
    camera.fx_px = camera.fy_px = K_wide(0, 0);
    camera.cx_px = K_wide(0, 2);
    camera.cy_px = K_wide(1, 2);
    cv::Mat radiance;
    cv::remap(sim::render(world, camera).radiance, radiance, wide_at_px, cv::noArray(), cv::INTER_LINEAR);
    return sim::expose(radiance, sensor, noise);
  };
  StereoFrame pair;
  pair.stamp_s = static_cast<double>(seed);
  pair.left = see(sim::leftCamera(rig, T_W_B), rig.left, 2 * seed);
  pair.right = see(sim::rightCamera(rig, T_W_B), rig.right, 2 * seed + 1);
  return pair;
}

}  // namespace flight_corridor::test_support
