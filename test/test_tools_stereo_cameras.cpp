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

TEST(StereoCameras, WithoutARotationAreRectifiedWhereNothingElseIsToBeDone) {
  StereoCameras cameras = camerasOf(expectedCalibration());
  cameras.left.R.fill(0.0);
  EXPECT_TRUE(areRectified(cameras));
  cameras.left.D[0] = -0.1;
  EXPECT_FALSE(areRectified(cameras));
  EXPECT_THROW(requireRectifiable(cameras), std::invalid_argument) << "how it is turned is not known";
  cameras.left.R = {2, 0, 0, 0, 2, 0, 0, 0, 2};
  EXPECT_THROW(requireRectifiable(cameras), std::invalid_argument);
  cameras.left.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  EXPECT_NO_THROW(requireRectifiable(cameras));
}

TEST(StereoCameras, OfAFisheyeAreKnownByEveryNameAndWithAFifthCoefficientOfZero) {
  StereoCameras cameras = camerasOf(expectedCalibration());
  for (const char* model : {"equidistant", "fisheye", "kannala_brandt4"}) {
    cameras.left.distortion_model = model;
    for (const std::vector<double>& D :
         {std::vector<double>{-0.01, 0.04, -0.04, 0.006}, {-0.01, 0.04, -0.04, 0.006, 0}}) {
      cameras.left.D = D;
      EXPECT_TRUE(isEquidistant(cameras.left)) << model;
      EXPECT_EQ(lensCoefficients(cameras.left).size(), 4u);
    }
    cameras.left.D = {-0.01, 0.04, -0.04, 0.006, 0.1};
    EXPECT_THROW(isEquidistant(cameras.left), std::invalid_argument);
  }
}

TEST(StereoCameras, AreDescribedWithTheirLensesAndAWarningOfAFisheyeInDisguise) {
  StereoCameras cameras = camerasOf(expectedCalibration());
  EXPECT_EQ(describe(cameras, false), "calibration: f 350 px, baseline 0.12 m");
  cameras.names = {"cam2", "cam3"};
  cameras.left.distortion_model = "equidistant";
  cameras.left.D = {-0.01, 0.04, -0.04, 0.006};
  EXPECT_EQ(describe(cameras, true),
            "calibration: left cam2 equidistant of 4 coefficients, f 350 px; right cam3 plumb_bob of 5 coefficients, f "
            "350 px; rectified f 350 px, baseline 0.12 m");
  cameras.right.K[0] = 0.34 * cameras.right.width;
  EXPECT_NE(describe(cameras, true).find("warning: 0.34 of the width, below 0.35, is a fisheye's"), std::string::npos);
  cameras.right.distortion_model = "equidistant";
  EXPECT_EQ(describe(cameras, true).find("warning"), std::string::npos);
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
