#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "sim/rig.hpp"
#include "sim/scenes.hpp"

namespace flight_corridor::sim {

/// leftCamera or rightCamera.
using CameraOfRig = Camera (*)(const Rig&, const Eigen::Isometry3d& T_W_B);

/// The light that a camera of a scene's rig collects while its shutter is open, rig.exposure_s centred on a moment of
/// the flight.
/// @return radiance, CV_32FC1.
cv::Mat collectLight(const Scene& scene, double time_s, CameraOfRig camera_of_rig);

}  // namespace flight_corridor::sim
