#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor::tools {

constexpr double kTyped = 1e-2;  ///< What rounding in a rotation typed by hand may differ, see isRotation().

/// Left and right by name.
struct PairNames {
  std::string left, right;
};

/// The two cameras of a pair, as ROS describes them: K and D describe the raw image, R and P the rectified image made
/// from it.
struct StereoCameras {
  sensor_msgs::CameraInfo left, right;
  bool is_rectification_computed =
      false;             ///< R and P were computed here: they do not apply to images rectified elsewhere.
  PairNames names = {};  ///< In a file that names its cameras.
};

/// "640x480".
std::string sizeText(const cv::Size& size);

/// The cameras of a pair that is rectified.
StereoCameras camerasOf(const StereoCalibration& calibration);

/// Whether raw images of these cameras are rectified images: no distortion, R is the identity or, all 0, not given, and
/// P sees as K.
bool areRectified(const StereoCameras& cameras);

/// The cameras that the rectified images have: no distortion, R is the identity, and K sees as P.
StereoCameras rectified(StereoCameras cameras);

/// Rectifies cameras that stand beside each other: fills R and P such that all pixels of the rectified images are seen
/// (OpenCV's stereoRectify, alpha = 0).
/// @param cameras sizes, K and D.
/// @param T_right_left pose of the left camera in the right one, [m].
/// @throws std::invalid_argument naming the impossible values: lenses of different models, cameras in one place, a
/// focal length that no lens has.
StereoCameras align(StereoCameras cameras, const Eigen::Isometry3d& T_right_left);

/// One line for people: focal length and baseline; of raw images, and of cameras with names, the lens models, with a
/// warning where one is likely another.
std::string describe(const StereoCameras& cameras, bool are_raw);

/// @throws std::invalid_argument naming what images cannot be rectified by: as isEquidistant, or R, where it is no
/// rotation.
void requireRectifiable(const StereoCameras& cameras);

/// Whether the lens maps angles to equal distances (cv::fisheye); otherwise it is radial-tangential, also rational.
/// @throws std::invalid_argument naming a model that is neither, coefficients that it does not have, or an impossible
/// K.
bool isEquidistant(const sensor_msgs::CameraInfo& camera);

/// D as OpenCV expects it: drivers that always send five values append 0 to the four of an equidistant lens.
std::vector<double> lensCoefficients(const sensor_msgs::CameraInfo& camera);

}  // namespace flight_corridor::tools
