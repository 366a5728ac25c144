#include "sim/rig.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace flight_corridor::sim {
namespace {

/// Bright, nearly upright and short. Drops are so near that both cameras see different ones: each image draws its own.
void addStreaks(int count, cv::RNG& random, cv::Mat& radiance) {
  cv::Mat streaks(radiance.size(), CV_32FC1, cv::Scalar(0.0));
  for (int i = 0; i < count; ++i) {
    const double u = random.uniform(0.0, 1.0) * radiance.cols;
    const double v = random.uniform(0.0, 1.0) * radiance.rows;
    const double length_px = random.uniform(0.01, 0.06) * radiance.rows;
    const double lean = random.uniform(-0.15, 0.15);
    const double brightness = random.uniform(0.1, 0.5);
    cv::line(streaks, cv::Point(cvRound(u), cvRound(v)),
             cv::Point(cvRound(u + lean * length_px), cvRound(v + length_px)), brightness);
  }
  radiance += streaks;
}

}  // namespace

Eigen::Matrix3d forwardFromOptical() {
  Eigen::Matrix3d R_B_C;  // columns: the camera's right, down and forward in B
  R_B_C << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return R_B_C;
}

Rig defaultRig() {
  Rig rig;
  rig.calibration = {{640, 480}, 350.0, 350.0, 320.0, 240.0, 318.5, 0.12};
  rig.T_B_C.linear() = forwardFromOptical();
  rig.T_B_C.translation() = Eigen::Vector3d(0.10, 0.06, 0.0);
  rig.T_B_L.translation() = rig.T_B_C.translation() + Eigen::Vector3d(0.0, -0.05, -0.06);
  return rig;
}

void scaleImages(Rig& rig, double factor) {
  StereoCalibration& c = rig.calibration;
  c.size_px = {cvRound(c.size_px.width * factor), cvRound(c.size_px.height * factor)};
  for (double* value : {&c.fx_px, &c.fy_px, &c.cx_px, &c.cy_px, &c.cx_right_px}) *value *= factor;
  rig.disparity_offset_px *= factor;
  rig.vertical_shift_px *= factor;
}

Camera leftCamera(const Rig& rig, const Eigen::Isometry3d& T_W_B) {
  const StereoCalibration& c = rig.calibration;
  return {c.size_px, c.fx_px, c.fy_px, c.cx_px, c.cy_px, T_W_B * rig.T_B_C};
}

Camera rightCamera(const Rig& rig, const Eigen::Isometry3d& T_W_B) {
  Camera camera = leftCamera(rig, T_W_B);
  camera.cx_px = rig.calibration.cx_right_px - rig.disparity_offset_px;
  camera.cy_px += rig.vertical_shift_px;
  camera.T_W_C.translate(Eigen::Vector3d(rig.calibration.baseline_m * (1.0 + rig.baseline_error), 0.0, 0.0));
  return camera;
}

cv::Mat expose(const cv::Mat& radiance, const ImageSensor& sensor, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat signal = radiance.clone(), variance, noise(radiance.size(), CV_32FC1), image;
  random.fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
  if (sensor.streaks > 0) addStreaks(sensor.streaks, random, signal);
  cv::GaussianBlur(signal, signal, {}, sensor.blur_sigma_px);
  signal = signal * sensor.gain + sensor.black_level;
  variance = signal * sensor.shot_noise + sensor.read_noise * sensor.read_noise;
  cv::sqrt(variance, variance);
  signal += noise.mul(variance);
  signal.convertTo(image, CV_8U);
  return image;
}

}  // namespace flight_corridor::sim
