#pragma once

#include <sensor_msgs/distortion_models.h>

#include <Eigen/Geometry>
#include <array>
#include <iomanip>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tools/stereo_cameras.hpp"

namespace flight_corridor::test_support {

/// Two cameras with distortion that look a little past each other, and the pair that they are rectified to.
struct RawRig {
  tools::StereoCameras cameras;
  Eigen::Isometry3d T_right_left = Eigen::Isometry3d::Identity();
};

inline Eigen::Matrix3d turned(double x_rad, double y_rad, double z_rad) {
  return (Eigen::AngleAxisd(z_rad, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(y_rad, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(x_rad, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

inline void setRaw(sensor_msgs::CameraInfo& camera, bool is_equidistant, double shift_px,
                   const Eigen::Matrix3d& R_rectified_raw) {
  const double f = camera.P[0] * 1.02;
  camera.K = {f, 0, camera.P[2] + shift_px, 0, 1.01 * f, camera.P[6] - shift_px, 0, 0, 1};
  camera.distortion_model =
      is_equidistant ? sensor_msgs::distortion_models::EQUIDISTANT : sensor_msgs::distortion_models::PLUMB_BOB;
  camera.D = is_equidistant ? std::vector<double>{-0.02, 0.01, -0.004, 0.001}
                            : std::vector<double>{-0.28, 0.07, 0.0004, -0.0003, 0.0};
  for (int i = 0; i < 9; ++i) camera.R[i] = R_rectified_raw(i / 3, i % 3);
}

/// The raw cameras of which the images of this calibration are made.
inline RawRig makeRawRig(const StereoCalibration& calibration, bool is_equidistant) {
  RawRig rig;
  rig.cameras = tools::camerasOf(calibration);
  const Eigen::Matrix3d R_left = turned(0.004, -0.006, 0.005), R_right = turned(-0.005, 0.007, -0.004);
  setRaw(rig.cameras.left, is_equidistant, 2.5, R_left);
  setRaw(rig.cameras.right, is_equidistant, -1.5, R_right);
  rig.T_right_left = Eigen::Isometry3d(R_right.transpose()) * Eigen::Translation3d(-calibration.baseline_m, 0.0, 0.0) *
                     Eigen::Isometry3d(R_left);
  return rig;
}

inline cv::Matx33d matrixK(const sensor_msgs::CameraInfo& camera) { return cv::Matx33d(camera.K.data()); }

/// Where points of the raw camera's frame lie in its image.
inline std::vector<cv::Point2d> projectRaw(const sensor_msgs::CameraInfo& camera,
                                           const std::vector<cv::Point3d>& points) {
  std::vector<cv::Point2d> pixels;
  if (tools::isEquidistant(camera)) {
    cv::fisheye::projectPoints(points, pixels, cv::Vec3d(), cv::Vec3d(), matrixK(camera), camera.D);
  } else {
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), matrixK(camera), camera.D, pixels);
  }
  return pixels;
}

/// Where pixels of the raw image lie in the rectified one.
inline std::vector<cv::Point2d> rectify(const sensor_msgs::CameraInfo& camera, const std::vector<cv::Point2d>& raw) {
  const cv::Matx33d R(camera.R.data());
  const cv::Matx34d P(camera.P.data());
  const cv::TermCriteria exact(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-10);
  std::vector<cv::Point2d> rectified;
  if (tools::isEquidistant(camera)) {
    cv::fisheye::undistortPoints(raw, rectified, matrixK(camera), camera.D, R, P);
  } else {
    cv::undistortPoints(raw, rectified, matrixK(camera), camera.D, R, P, exact);
  }
  return rectified;
}

/// The raw image of which a rectified one is made.
inline cv::Mat toRaw(const sensor_msgs::CameraInfo& camera, const cv::Mat& rectified) {
  std::vector<cv::Point2d> pixels;
  for (int v = 0; v < rectified.rows; ++v) {
    for (int u = 0; u < rectified.cols; ++u) pixels.emplace_back(u, v);
  }
  cv::Mat map(rectify(camera, pixels), true), raw;
  map.convertTo(map, CV_32FC2);
  cv::remap(rectified, raw, map.reshape(2, rectified.rows), cv::noArray(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return raw;
}

/// "a, b, c", all digits.
template <typename Numbers>
std::string listed(const Numbers& numbers, const char* separator = ", ") {
  std::ostringstream text;
  text << std::setprecision(17);
  for (std::size_t i = 0; i < numbers.size(); ++i) text << (i == 0 ? "" : separator) << numbers[i];
  return text.str();
}

/// Row by row.
template <typename Matrix>
std::vector<double> rowsOf(const Matrix& matrix) {
  std::vector<double> numbers;
  for (int row = 0; row < matrix.rows(); ++row) {
    for (int column = 0; column < matrix.cols(); ++column) numbers.push_back(matrix(row, column));
  }
  return numbers;
}

inline std::vector<double> intrinsics(const sensor_msgs::CameraInfo& camera) {
  return {camera.K[0], camera.K[4], camera.K[2], camera.K[5]};
}

inline std::string rosYaml(const sensor_msgs::CameraInfo& camera) {
  std::ostringstream text;
  const auto matrix = [&](const char* key, int columns, const auto& numbers) {
    text << key << ":\n  rows: " << numbers.size() / columns << "\n  cols: " << columns << "\n  data: ["
         << listed(numbers) << "]\n";
  };
  text << "image_width: " << camera.width << "\nimage_height: " << camera.height << "\ncamera_name: narrow_stereo\n";
  matrix("camera_matrix", 3, camera.K);
  text << "distortion_model: " << camera.distortion_model << "\n";
  matrix("distortion_coefficients", static_cast<int>(camera.D.size()), camera.D);
  matrix("rectification_matrix", 3, camera.R);
  matrix("projection_matrix", 4, camera.P);
  return text.str();
}

inline std::string kalibrYaml(const RawRig& rig) {
  std::ostringstream text;
  for (const bool is_left : {true, false}) {
    const auto& camera = is_left ? rig.cameras.left : rig.cameras.right;
    const bool is_equidistant = camera.distortion_model == sensor_msgs::distortion_models::EQUIDISTANT;
    const std::vector<double> D(camera.D.begin(), camera.D.begin() + 4);
    text << (is_left ? "cam0:\n" : "cam1:\n");
    if (!is_left) {
      text << "  T_cn_cnm1:\n";
      for (int row = 0; row < 4; ++row) text << "  - [" << listed(rowsOf(rig.T_right_left.matrix().row(row))) << "]\n";
    }
    text << "  cam_overlaps: [" << is_left << "]\n  camera_model: pinhole\n  distortion_coeffs: [" << listed(D)
         << "]\n  distortion_model: " << (is_equidistant ? "equidistant" : "radtan") << "\n  intrinsics: ["
         << listed(intrinsics(camera)) << "]\n  resolution: [" << camera.width << ", " << camera.height
         << "]\n  rostopic: /cam" << !is_left << "/image_raw\n";
  }
  return text.str();
}

/// @param T_B_camera pose of the camera in the body.
inline std::string eurocYaml(const sensor_msgs::CameraInfo& camera, const Eigen::Isometry3d& T_B_camera) {
  const bool is_equidistant = camera.distortion_model == sensor_msgs::distortion_models::EQUIDISTANT;
  const std::vector<double> D(camera.D.begin(), camera.D.begin() + 4);
  std::ostringstream text;
  text << "%YAML:1.0\n# sensor\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: ["
       << listed(rowsOf(T_B_camera.matrix()), ",\n    ") << "]\nrate_hz: 20\nresolution: [" << camera.width << ", "
       << camera.height << "]\ncamera_model: pinhole\nintrinsics: [" << listed(intrinsics(camera))
       << "] #fu, fv, cu, cv\ndistortion_model: " << (is_equidistant ? "equidistant" : "radial-tangential")
       << "\ndistortion_coefficients: [" << listed(D) << "]\n";
  return text.str();
}

template <typename Numbers>
std::string openCvMatrix(const std::string& key, int columns, const Numbers& numbers) {
  return key + ": !!opencv-matrix\n   rows: " + std::to_string(numbers.size() / columns) +
         "\n   cols: " + std::to_string(columns) + "\n   dt: d\n   data: [ " + listed(numbers) + " ]\n";
}

/// @param with_projections R1 P1 R2 P2, else R T.
inline std::string openCvYaml(const RawRig& rig, bool with_projections, double units_per_m = 1.0) {
  const sensor_msgs::CameraInfo &left = rig.cameras.left, &right = rig.cameras.right;
  const auto D = [](const auto& camera) {
    return openCvMatrix("", static_cast<int>(camera.D.size()), camera.D).substr(1);
  };
  std::string text = "%YAML:1.0\n---\n" + openCvMatrix("M1", 3, left.K) + "D1:" + D(left) +
                     openCvMatrix("M2", 3, right.K) + "D2:" + D(right);
  if (left.distortion_model == sensor_msgs::distortion_models::EQUIDISTANT) text += "model: fisheye\n";
  if (with_projections) {
    return text + openCvMatrix("R1", 3, left.R) + openCvMatrix("R2", 3, right.R) + openCvMatrix("P1", 4, left.P) +
           openCvMatrix("P2", 4, right.P);
  }
  const Eigen::Vector3d T = units_per_m * rig.T_right_left.translation();
  return text + openCvMatrix("R", 3, rowsOf(rig.T_right_left.linear())) + openCvMatrix("T", 1, rowsOf(T));
}

/// @param resolution as the sections are called.
inline std::string zedConf(const RawRig& rig, const std::string& resolution) {
  std::ostringstream text;
  text << std::setprecision(17);
  const Eigen::AngleAxisd rotation(Eigen::Matrix3d(rig.T_right_left.linear()));
  const Eigen::Vector3d r = rotation.angle() * rotation.axis(), t_mm = -1000.0 * rig.T_right_left.translation();
  for (const bool is_left : {true, false}) {
    const auto& camera = is_left ? rig.cameras.left : rig.cameras.right;
    text << (is_left ? "[LEFT_CAM_" : "[RIGHT_CAM_") << resolution << "]\nfx=" << camera.K[0] << "\nfy=" << camera.K[4]
         << "\ncx=" << camera.K[2] << "\ncy=" << camera.K[5] << "\nk1=" << camera.D[0] << "\nk2=" << camera.D[1];
    const bool is_fisheye = camera.distortion_model == sensor_msgs::distortion_models::EQUIDISTANT;
    text << (is_fisheye ? "\nk3=" : "\np1=") << camera.D[2] << (is_fisheye ? "\nk4=" : "\np2=") << camera.D[3]
         << (is_fisheye ? "\n\n" : "\nk3=0\n\n");
  }
  text << "[STEREO]\nBaseline=" << t_mm.x() << "\nTY=" << t_mm.y() << "\nTZ=" << t_mm.z() << "\nRX_" << resolution
       << '=' << r.x() << "\nCV_" << resolution << '=' << r.y() << "\nRZ_" << resolution << '=' << r.z() << "\n";
  return text.str();
}

}  // namespace flight_corridor::test_support
