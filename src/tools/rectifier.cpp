#include "tools/rectifier.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace flight_corridor::tools {

Rectifier::Rectifier(const StereoCameras& cameras) {
  requireRectifiable(cameras);
  left_ = mapsOf(cameras.left);
  right_ = mapsOf(cameras.right);
}

Rectifier::Maps Rectifier::mapsOf(const sensor_msgs::CameraInfo& camera) {
  const cv::Matx33d K(camera.K.data()), R(camera.R.data());
  const cv::Matx33d K_P = cv::Matx34d(camera.P.data()).get_minor<3, 3>(0, 0);
  const cv::Size size(static_cast<int>(camera.width), static_cast<int>(camera.height));
  const std::vector<double> D = lensCoefficients(camera);
  Maps maps;
  if (isEquidistant(camera)) {
    cv::fisheye::initUndistortRectifyMap(K, D, R, K_P, size, CV_16SC2, maps.whole_px, maps.fraction);
  } else {
    cv::initUndistortRectifyMap(K, D, R, K_P, size, CV_16SC2, maps.whole_px, maps.fraction);
  }
  return maps;
}

cv::Mat Rectifier::remap(const cv::Mat& raw, const Maps& maps) {
  if (raw.size() != maps.whole_px.size()) {
    throw std::invalid_argument("the image is " + sizeText(raw.size()) + ", its camera's calibration is for " +
                                sizeText(maps.whole_px.size()));
  }
  cv::Mat rectified;
  cv::remap(raw, rectified, maps.whole_px, maps.fraction, cv::INTER_LINEAR);
  return rectified;
}

}  // namespace flight_corridor::tools
