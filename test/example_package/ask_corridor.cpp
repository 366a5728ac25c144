#include <cstdio>
#include <opencv2/core.hpp>

#include "flight_corridor/pipeline.hpp"

// A wall with a random texture that fills both images, at a whole disparity.
flight_corridor::StereoFrame imagesOfWall(cv::Size size_px, int disparity_px) {
  cv::Mat wall(size_px.height, size_px.width + disparity_px, CV_8UC1);
  cv::theRNG().state = 1;
  cv::randu(wall, 0, 256);
  flight_corridor::StereoFrame frame;
  frame.stamp_s = 1.0;
  frame.left = wall(cv::Rect({0, 0}, size_px));
  frame.right = wall(cv::Rect({disparity_px, 0}, size_px));
  return frame;
}

int main() {
  flight_corridor::StereoCalibration calibration;
  calibration.size_px = {640, 480};
  calibration.fx_px = calibration.fy_px = 350.0;
  calibration.cx_px = calibration.cx_right_px = 319.5;
  calibration.cy_px = 239.5;
  calibration.baseline_m = 0.12;

  flight_corridor::Config config;
  config.corridor.length_m = 3.0;  // nearer obstacles block
  const flight_corridor::StereoGeometry geometry(calibration);
  flight_corridor::Pipeline pipeline(config, geometry, flight_corridor::Rig());

  const auto& verdict = pipeline.process(imagesOfWall(calibration.size_px, 21)).verdict;  // 350 * 0.12 / 21 = 2 m
  std::printf("corridor: %s, clear for %.2f m\n", toString(verdict.state), verdict.clear_distance_m);

  // A box of 0.6 m x 1.2 m x 0.4 m that begins 1 m ahead, in the left camera's frame.
  flight_corridor::Box box;
  box.T_M_F = flight_corridor::opticalFromForward() * Eigen::Translation3d(1.0, 0.0, 0.0);
  box.size_m = {0.6, 1.2, 0.4};
  const auto answer = pipeline.query(box);
  std::printf("box: %s %s\n", toString(answer.state), flight_corridor::describeReasons(answer.reasons).c_str());
  return answer.state == flight_corridor::State::Free ? 0 : 1;
}
