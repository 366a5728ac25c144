#include "tools/stereo_cameras.hpp"

#include <sensor_msgs/distortion_models.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <sstream>
#include <stdexcept>
#include <string>

#include "flight_corridor/geometry/box.hpp"

namespace flight_corridor::tools {
namespace {

namespace models = sensor_msgs::distortion_models;
using sensor_msgs::CameraInfo;

constexpr double kSame = 1e-6;            // rounding of a rotation
constexpr double kSame_px = 0.01;         // what rounding in a calibration file may differ
constexpr double kWidestPlumbBob = 0.35;  // focal length over width: a view of 110 degrees
constexpr std::size_t kEquidistantCoefficients = 4;
constexpr double kFocalRange[] = {0.1, 10.0};  // of the rectified image over that of the raw one

/// @param shift_m position of the camera along +x of the left one.
CameraInfo rectifiedCamera(const StereoCalibration& calibration, double cx_px, double shift_m) {
  CameraInfo info;
  info.width = static_cast<std::uint32_t>(calibration.size_px.width);
  info.height = static_cast<std::uint32_t>(calibration.size_px.height);
  const double fx = calibration.fx_px, fy = calibration.fy_px, cy = calibration.cy_px;
  info.distortion_model = models::PLUMB_BOB;
  info.D.resize(5, 0.0);
  info.K = {fx, 0, cx_px, 0, fy, cy, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {fx, 0, cx_px, -fx * shift_m, 0, fy, cy, 0, 0, 0, 1, 0};
  return info;
}

/// K of the rectified image: P without its last column.
CameraInfo::_K_type rectifiedK(const CameraInfo& camera) {
  const auto& P = camera.P;
  return {P[0], P[1], P[2], P[4], P[5], P[6], P[8], P[9], P[10]};
}

template <typename Numbers>
bool areClose(const Numbers& a, const Numbers& b, double tolerance) {
  return std::equal(a.begin(), a.end(), b.begin(), [&](double x, double y) { return std::abs(x - y) <= tolerance; });
}

bool isZero(double number) { return number == 0.0; }

bool hasEquidistantModel(const CameraInfo& camera) {
  const std::string& model = camera.distortion_model;
  return model == models::EQUIDISTANT || model == "fisheye" || model == "kannala_brandt4";
}

bool areZero(const CameraInfo::_R_type& R) { return std::all_of(R.begin(), R.end(), isZero); }

/// A camera without K is not calibrated: there is nothing to rectify it by.
bool isRectified(const CameraInfo& camera) {
  const CameraInfo::_R_type identity{1, 0, 0, 0, 1, 0, 0, 0, 1};
  if (isZero(camera.K[0])) return true;
  return !hasEquidistantModel(camera) && std::all_of(camera.D.begin(), camera.D.end(), isZero) &&
         (areClose(camera.R, identity, kSame) || areZero(camera.R)) && areClose(camera.K, rectifiedK(camera), kSame_px);
}

void makeRectified(CameraInfo& camera) {
  camera.distortion_model = models::PLUMB_BOB;
  camera.D.assign(5, 0.0);
  camera.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  camera.K = rectifiedK(camera);
}

void requireRotation(const char* side, const CameraInfo::_R_type& numbers) {
  const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
  if (isRotation(R, kTyped)) return;
  throw std::invalid_argument(std::string("R of ") + side + (areZero(numbers) ? " is all 0" : " is not a rotation") +
                              ": the rotation of the pair is not known");
}

std::string describeLens(const CameraInfo& camera, const std::string& name) {
  const std::size_t count = lensCoefficients(camera).size();
  std::ostringstream text;
  text << (name.empty() ? "" : " " + name) << ' '
       << (camera.distortion_model.empty() ? "no lens model" : camera.distortion_model) << " of " << count
       << " coefficients, f " << camera.K[0] << " px";
  const double ratio = camera.K[0] / camera.width;
  if (camera.distortion_model == models::PLUMB_BOB && ratio < kWidestPlumbBob) {
    text << " (warning: " << ratio << " of the width, below " << kWidestPlumbBob
         << ", is a fisheye's: is its model equidistant? A wrong model gives wrong depths)";
  }
  return text.str();
}

cv::Matx33d matrixK(const CameraInfo& camera) { return cv::Matx33d(camera.K.data()); }

void requireFocalLength(const CameraInfo& camera) {
  const double ratio = camera.P[0] / camera.K[0];
  if (kFocalRange[0] <= ratio && ratio <= kFocalRange[1]) return;
  throw std::invalid_argument("rectification turns the focal length of " + std::to_string(camera.K[0]) + " px into " +
                              std::to_string(camera.P[0]) + " px, more than a factor of " +
                              std::to_string(static_cast<int>(kFocalRange[1])) +
                              ": are the distortion coefficients those of model " + camera.distortion_model + "?");
}

}  // namespace

std::string sizeText(const cv::Size& size) { return std::to_string(size.width) + "x" + std::to_string(size.height); }

StereoCameras camerasOf(const StereoCalibration& calibration) {
  return {rectifiedCamera(calibration, calibration.cx_px, 0.0),
          rectifiedCamera(calibration, calibration.cx_right_px, calibration.baseline_m)};
}

bool areRectified(const StereoCameras& cameras) { return isRectified(cameras.left) && isRectified(cameras.right); }

StereoCameras rectified(StereoCameras cameras) {
  makeRectified(cameras.left);
  makeRectified(cameras.right);
  return cameras;
}

StereoCameras align(StereoCameras cameras, const Eigen::Isometry3d& T_right_left) {
  const bool is_equidistant = isEquidistant(cameras.left);
  if (is_equidistant != isEquidistant(cameras.right)) {
    throw std::invalid_argument("lens models of left and right differ (" + cameras.left.distortion_model + ", " +
                                cameras.right.distortion_model + ")");
  }
  const Eigen::Vector3d t = T_right_left.translation();
  if (!(t.norm() > 0.0)) throw std::invalid_argument("both cameras have the same position: the baseline is 0 m");
  const cv::Size size(static_cast<int>(cameras.left.width), static_cast<int>(cameras.left.height));
  cv::Matx33d R, R_left, R_right;
  cv::eigen2cv(Eigen::Matrix3d(T_right_left.linear()), R);
  const cv::Vec3d T(t.x(), t.y(), t.z());
  cv::Matx34d P_left, P_right;
  cv::Matx44d Q;
  const cv::Matx33d K_left = matrixK(cameras.left), K_right = matrixK(cameras.right);
  if (is_equidistant) {
    cv::fisheye::stereoRectify(K_left, lensCoefficients(cameras.left), K_right, lensCoefficients(cameras.right), size,
                               R, T, R_left, R_right, P_left, P_right, Q, cv::CALIB_ZERO_DISPARITY, size);
  } else {
    cv::stereoRectify(K_left, cameras.left.D, K_right, cameras.right.D, size, R, T, R_left, R_right, P_left, P_right, Q,
                      cv::CALIB_ZERO_DISPARITY, 0.0, size);
  }
  std::copy_n(R_left.val, 9, cameras.left.R.begin());
  std::copy_n(R_right.val, 9, cameras.right.R.begin());
  std::copy_n(P_left.val, 12, cameras.left.P.begin());
  std::copy_n(P_right.val, 12, cameras.right.P.begin());
  requireFocalLength(cameras.left);
  cameras.is_rectification_computed = true;
  return cameras;
}

std::string describe(const StereoCameras& cameras, bool are_raw) {
  const CameraInfo &left = cameras.left, &right = cameras.right;
  std::ostringstream text;
  text << "calibration: ";
  if (are_raw || !cameras.names.left.empty()) {
    text << "left" << describeLens(left, cameras.names.left) << "; right" << describeLens(right, cameras.names.right)
         << "; rectified ";
  }
  if (!(left.P[0] > 0.0)) return text.str() + "none, P holds no focal length";
  text << "f " << left.P[0] << " px, baseline " << (left.P[3] - right.P[3]) / left.P[0] << " m";
  return text.str();
}

void requireRectifiable(const StereoCameras& cameras) {
  isEquidistant(cameras.left);
  isEquidistant(cameras.right);
  requireRotation("left", cameras.left.R);
  requireRotation("right", cameras.right.R);
}

std::vector<double> lensCoefficients(const CameraInfo& camera) {
  std::vector<double> coefficients = camera.D;
  while (hasEquidistantModel(camera) && coefficients.size() > kEquidistantCoefficients && isZero(coefficients.back())) {
    coefficients.pop_back();
  }
  return coefficients;
}

bool isEquidistant(const CameraInfo& camera) {
  const auto& K = camera.K;
  const bool is_finite = std::all_of(K.begin(), K.end(), [](double k) { return std::isfinite(k); }) &&
                         std::all_of(camera.D.begin(), camera.D.end(), [](double d) { return std::isfinite(d); });
  if (!is_finite || !(K[0] > 0.0 && K[4] > 0.0)) {
    throw std::invalid_argument("a focal length must be positive, and K and D finite (fx " + std::to_string(K[0]) +
                                ", fy " + std::to_string(K[4]) + ")");
  }
  const std::string& model = camera.distortion_model;
  const std::size_t count = lensCoefficients(camera).size();
  const bool is_equidistant = hasEquidistantModel(camera);
  if (is_equidistant && count == kEquidistantCoefficients) return true;
  if (!is_equidistant && std::all_of(camera.D.begin(), camera.D.end(), isZero)) return false;
  const bool is_known = (model == models::PLUMB_BOB && (count == 4 || count == 5)) ||
                        (model == models::RATIONAL_POLYNOMIAL && (count == 8 || count == 12 || count == 14));
  if (is_known) return false;
  throw std::invalid_argument(
      "lens model \"" + model + "\" with " + std::to_string(count) +
      " coefficients; supported are plumb_bob with 4 or 5, rational_polynomial with 8, 12 or 14, equidistant with 4");
}

}  // namespace flight_corridor::tools
