#include <gtest/gtest.h>

#include <stdexcept>

#include "ros/conversions.hpp"
#include "support/raw_rig.hpp"
#include "tools/stereo_cameras.hpp"

namespace flight_corridor::tools {
namespace {

StereoCalibration expectedCalibration() {
  StereoCalibration calibration;
  calibration.size_px = {640, 480};
  calibration.fx_px = calibration.fy_px = 350.0;
  calibration.cx_px = 320.0;
  calibration.cx_right_px = 318.5;
  calibration.cy_px = 240.0;
  calibration.baseline_m = 0.12;
  return calibration;
}

TEST(StereoCameras, OfARectifiedPairAreRectifiedAndHoldItsNumbers) {
  const StereoCameras cameras = camerasOf(expectedCalibration());
  EXPECT_TRUE(areRectified(cameras));
  const StereoCalibration calibration = flight_corridor_ros::toCalibration(cameras.left, cameras.right);
  EXPECT_EQ(calibration.cx_right_px, 318.5);
  EXPECT_DOUBLE_EQ(calibration.baseline_m, 0.12);
}

TEST(StereoCameras, OfWhichOneHasALensOrATurnAreRaw) {
  for (auto change : {+[](sensor_msgs::CameraInfo& camera) { camera.D[1] = 1e-3; },
                      +[](sensor_msgs::CameraInfo& camera) { camera.R[1] = 1e-3; },
                      +[](sensor_msgs::CameraInfo& camera) { camera.K[2] += 1.0; },
                      +[](sensor_msgs::CameraInfo& camera) { camera.distortion_model = "equidistant"; }}) {
    StereoCameras cameras = camerasOf(expectedCalibration());
    change(cameras.right);
    EXPECT_FALSE(areRectified(cameras));
    EXPECT_TRUE(areRectified(rectified(cameras)));
  }
}

TEST(StereoCameras, WithoutKCannotBeRectified) {
  StereoCameras cameras = camerasOf(expectedCalibration());
  cameras.left.K.fill(0.0);
  cameras.right.K.fill(0.0);
  EXPECT_TRUE(areRectified(cameras));
}

TEST(StereoCameras, RefuseWhatNoPairIs) {
  StereoCameras cameras = camerasOf(expectedCalibration());
  EXPECT_THROW(align(cameras, Eigen::Isometry3d::Identity()), std::invalid_argument);  // in one place
  const Eigen::Isometry3d beside(Eigen::Translation3d(-0.12, 0.0, 0.0));
  EXPECT_NO_THROW(align(cameras, beside));
  cameras.right.distortion_model = "equidistant";
  cameras.right.D.resize(4);
  EXPECT_THROW(align(cameras, beside), std::invalid_argument);  // different lenses
  cameras = camerasOf(expectedCalibration());
  cameras.left.D = {1e3, 0.0, 0.0, 0.0};
  EXPECT_THROW(align(cameras, beside), std::exception);
  cameras.left.D = {0.1, 0.0, 0.0};
  EXPECT_THROW(isEquidistant(cameras.left), std::invalid_argument);
  cameras.left.D = {0.1, 0.0, 0.0, kNaN};
  EXPECT_THROW(isEquidistant(cameras.left), std::invalid_argument);
}

}  // namespace
}  // namespace flight_corridor::tools
