#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "sim/render.hpp"
#include "sim/rig.hpp"

namespace flight_corridor::sim {
namespace {

/// Quarter-size images; equal principal points.
Rig smallParallelRig() {
  Rig rig = defaultRig();
  scaleImages(rig, 0.25);
  rig.calibration.cx_right_px = rig.calibration.cx_px;
  return rig;
}

/// That right equals left moved by so much, to a twentieth of a pixel: moved by one pixel more it differs twenty times
/// as much. (Not to the last bit: a wall's footprint is a little larger where it is seen aslant.)
void expectMoved(const cv::Mat& left, const cv::Mat& right, const cv::Point& by_px) {
  const auto difference = [&](const cv::Point& tried_px) {
    constexpr int kBorder_px = 15;
    const cv::Rect inner(kBorder_px, kBorder_px, left.cols - 2 * kBorder_px, left.rows - 2 * kBorder_px);
    return cv::norm(left(inner), right(inner + tried_px), cv::NORM_L2);
  };
  EXPECT_LT(difference(by_px), difference(by_px + cv::Point(1, 0)) / 20.0);
  EXPECT_LT(difference(by_px), difference(by_px + cv::Point(0, 1)) / 20.0);
}

/// The pair's disparity before a wall that fills both images.
void expectDisparity(const Rig& rig, double depth_m, int disparity_px) {
  const double x_m = rig.T_B_C.translation().x() + depth_m;
  const std::vector<Primitive> wall{makeBox({x_m + 0.5, 0, 0}, {1, 40, 40}, {})};
  const Eigen::Isometry3d T_W_B = Eigen::Isometry3d::Identity();
  expectMoved(render(wall, leftCamera(rig, T_W_B)).radiance, render(wall, rightCamera(rig, T_W_B)).radiance,
              {-disparity_px, 0});
}

TEST(Rig, AWallsDisparityIsFocalLengthTimesBaselineOverDepth) {
  Rig rig = smallParallelRig();
  const StereoGeometry geometry(rig.calibration);
  expectDisparity(rig, geometry.depth(4.0), 4);
  expectDisparity(rig, geometry.depth(7.0), 7);
}

TEST(Rig, ARightPrincipalPointToTheLeftAddsToTheDisparityOfTheImages) {
  Rig rig = smallParallelRig();
  rig.calibration.cx_right_px = rig.calibration.cx_px - 3.0;
  expectDisparity(rig, StereoGeometry(rig.calibration).depth(4.0), 4 + 3);
}

TEST(Rig, TheImagesAreMadeWithTheTrueBaselineAndOffset) {
  Rig rig = smallParallelRig();
  rig.baseline_error = 0.25;
  expectDisparity(rig, StereoGeometry(rig.calibration).depth(4.0), 5);
  rig.disparity_offset_px = 2.0;
  expectDisparity(rig, StereoGeometry(rig.calibration).depth(4.0), 7);
}

TEST(Rig, AVerticalShiftLowersTheRightImage) {
  Rig rig = smallParallelRig();
  rig.vertical_shift_px = 2.0;
  rig.calibration.baseline_m = 1e-9;
  const std::vector<Primitive> wall{makeBox({4.0, 0, 0}, {1, 40, 40}, {})};
  const Eigen::Isometry3d T_W_B = Eigen::Isometry3d::Identity();
  expectMoved(render(wall, leftCamera(rig, T_W_B)).radiance, render(wall, rightCamera(rig, T_W_B)).radiance, {0, 2});
}

TEST(Rig, SmallerImagesSeeTheSameField) {
  const Rig full = defaultRig(), small = smallParallelRig();
  EXPECT_NEAR(full.calibration.size_px.width / full.calibration.fx_px,
              small.calibration.size_px.width / small.calibration.fx_px, 1e-9);
}

TEST(Expose, HasTheMeanAndNoiseOfItsSensor) {
  ImageSensor sensor;
  const cv::Mat image = expose(cv::Mat(200, 200, CV_32FC1, cv::Scalar(0.4)), sensor, 3);
  cv::Scalar mean, std;
  cv::meanStdDev(image, mean, std);
  const double signal = 0.4 * sensor.gain + sensor.black_level;
  const double variance = signal * sensor.shot_noise + sensor.read_noise * sensor.read_noise + 1.0 / 12.0;  // rounding
  // 40 000 samples: the mean to sigma/200, the standard deviation to sigma/283; five times that.
  EXPECT_NEAR(mean[0], signal, 0.04);
  EXPECT_NEAR(std[0], std::sqrt(variance), 0.03);
}

TEST(Expose, SaturatesAndDependsOnTheSeedOnly) {
  ImageSensor sensor;
  EXPECT_EQ(cv::countNonZero(expose(cv::Mat(20, 20, CV_32FC1, cv::Scalar(2.0)), sensor, 1) == 255), 400);
  const cv::Mat radiance(20, 20, CV_32FC1, cv::Scalar(0.5));
  EXPECT_EQ(cv::norm(expose(radiance, sensor, 1), expose(radiance, sensor, 1), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(expose(radiance, sensor, 1), expose(radiance, sensor, 2), cv::NORM_INF), 0.0);
}

TEST(Expose, RainAddsBrightStreaksThatDifferBySeed) {
  const cv::Mat radiance(480, 640, CV_32FC1, cv::Scalar(0.4));
  ImageSensor dry, wet;
  wet.streaks = 100;
  const auto streaked = [&](std::uint64_t seed) -> cv::Mat {
    cv::Mat added;
    cv::subtract(expose(radiance, wet, seed), expose(radiance, dry, seed), added);
    return added > 10;
  };
  const cv::Mat one = streaked(1), other = streaked(2);
  // 100 streaks of 5 to 29 px, one pixel wide, blurred to two or three; some fall over each other or leave the image.
  EXPECT_GT(cv::countNonZero(one), 800);
  EXPECT_LT(cv::countNonZero(one), 6000);
  EXPECT_GT(cv::countNonZero(one != other), 800);
}

}  // namespace
}  // namespace flight_corridor::sim
