#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "ros/conversions.hpp"
#include "ros/image_scale.hpp"
#include "ros/processor.hpp"
#include "sim/simulation.hpp"

namespace flight_corridor_ros {
namespace {

using namespace flight_corridor;

constexpr double kScales[] = {1.0, 0.5, 0.25, 0.125};

sensor_msgs::CameraInfoPtr cameraInfo(const StereoCalibration& calibration, double cx_px, double baseline_m) {
  const auto info = boost::make_shared<sensor_msgs::CameraInfo>();
  const double fx = calibration.fx_px, fy = calibration.fy_px, cy = calibration.cy_px;
  info->width = static_cast<std::uint32_t>(calibration.size_px.width);
  info->height = static_cast<std::uint32_t>(calibration.size_px.height);
  info->D = {-0.3, 0.1, 0.0, 0.0, 0.0};
  info->K = {fx + 3.0, 0, cx_px + 2.0, 0, fy + 3.0, cy + 2.0, 0, 0, 1};
  info->P = {fx, 0, cx_px, -fx * baseline_m, 0, fy, cy, 0, 0, 0, 1, 0};
  return info;
}

const StereoCalibration kRig{{640, 480}, 350.0, 352.0, 320.0, 240.0, 326.0, 0.12};

StereoCalibration scaledRig(double scale) {
  return toCalibration(*scaled(cameraInfo(kRig, kRig.cx_px, 0.0), scale),
                       *scaled(cameraInfo(kRig, kRig.cx_right_px, kRig.baseline_m), scale));
}

TEST(ImageScale, TakesScalesOfWholeSquaresAlone) {
  for (const double scale : kScales) EXPECT_TRUE(isImageScale(scale)) << scale;
  for (const double scale : {0.0, -0.5, 0.3, 1.0 / 3.0, 0.75, 0.0625, 2.0, kInfinity, kNaN}) {
    EXPECT_FALSE(isImageScale(scale)) << scale;
  }
}

/// A pixel of the scaled image is a square of pixels: its edges, half a pixel from its centre, are those of the square.
TEST(ImageScale, APointProjectsToTheScaledPixel) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const StereoGeometry full(kRig);
  for (const double scale : kScales) {
    const StereoGeometry small(scaledRig(scale));
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3d p_C(2.0 * number(random), number(random), 3.0 + number(random));
      const Eigen::Vector2d half(0.5, 0.5), expected = scale * (full.project(p_C) + half) - half;
      EXPECT_LT((small.project(p_C) - expected).norm(), 1e-9) << scale << ": " << p_C.transpose();
    }
  }
}

TEST(ImageScale, DisparityScalesAndTheBaselineStays) {
  for (const double scale : kScales) {
    const StereoCalibration small = scaledRig(scale);
    EXPECT_NEAR(small.baseline_m, kRig.baseline_m, 1e-12);
    EXPECT_NEAR(small.cx_px - small.cx_right_px, scale * (kRig.cx_px - kRig.cx_right_px), 1e-9);
    EXPECT_EQ(small.size_px, cv::Size(cvRound(640 * scale), cvRound(480 * scale)));
    EXPECT_NEAR(StereoGeometry(small).disparity(2.0), scale * StereoGeometry(kRig).disparity(2.0), 1e-9);
  }
}

TEST(ImageScale, AnImageMovesAsItsCameraInfoSays) {
  const cv::Point2d centre(301.25, 222.75);
  cv::Mat image(480, 640, CV_8UC1);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const cv::Point2d off = cv::Point2d(u, v) - centre;
      image.at<uchar>(v, u) = cv::saturate_cast<uchar>(255.0 * std::exp(-off.dot(off) / (2.0 * 20.0 * 20.0)));
    }
  }
  for (const double scale : kScales) {
    const cv::Moments moments = cv::moments(scaled(image, scale));
    // Rounding to whole grey levels moves the centre of 255 levels of a blob of 20 px by less than a hundredth of it.
    EXPECT_NEAR(moments.m10 / moments.m00, scale * (centre.x + 0.5) - 0.5, 0.02) << scale;
    EXPECT_NEAR(moments.m01 / moments.m00, scale * (centre.y + 0.5) - 0.5, 0.02) << scale;
  }
}

TEST(ImageScale, TheRawCamerasMatrixIsScaledAndItsDistortionStays) {
  const auto full = cameraInfo(kRig, kRig.cx_px, 0.0);
  const auto half = scaled(sensor_msgs::CameraInfoConstPtr(full), 0.5);
  EXPECT_EQ(half->K[0], 0.5 * full->K[0]);
  EXPECT_EQ(half->K[5], 0.5 * (full->K[5] + 0.5) - 0.5);
  EXPECT_EQ(half->K[8], 1.0);
  EXPECT_EQ(half->D, full->D);
}

TEST(ImageScale, WhatFillsNoSquareIsLeftOut) {
  StereoCalibration odd = kRig;
  odd.size_px = {643, 481};
  const auto info = scaled(cameraInfo(odd, odd.cx_px, 0.0), 0.25);
  const cv::Mat image = scaled(cv::Mat(odd.size_px, CV_8UC1, cv::Scalar(7)), 0.25);
  EXPECT_EQ(image.size(), cv::Size(160, 120));
  EXPECT_EQ(cv::Size(static_cast<int>(info->width), static_cast<int>(info->height)), image.size());
  EXPECT_TRUE(scaled(cv::Mat(2, 2, CV_8UC1), 0.25).empty());
}

TEST(ImageScale, AtOneNothingIsCopied) {
  const cv::Mat image(480, 640, CV_8UC1);
  EXPECT_EQ(scaled(image, 1.0).data, image.data);
  const sensor_msgs::CameraInfoConstPtr info = cameraInfo(kRig, kRig.cx_px, 0.0);
  EXPECT_EQ(scaled(info, 1.0), info);
}

TEST(ImageScale, BinningAndRegionsOfInterestAreRefusedAsBefore) {
  const auto right = scaled(cameraInfo(kRig, kRig.cx_right_px, kRig.baseline_m), 0.5);
  const auto isTaken = [&right](const sensor_msgs::CameraInfoPtr& left) {
    try {
      toCalibration(*scaled(left, 0.5), *right);
      return true;
    } catch (const std::invalid_argument&) {
      return false;
    }
  };
  const auto full = cameraInfo(kRig, kRig.cx_px, 0.0), binned = cameraInfo(kRig, kRig.cx_px, 0.0),
             shifted = cameraInfo(kRig, kRig.cx_px, 0.0), narrow = cameraInfo(kRig, kRig.cx_px, 0.0);
  full->roi.width = 640;
  full->roi.height = 480;
  binned->binning_x = binned->binning_y = 2;
  shifted->roi = full->roi;
  shifted->roi.x_offset = 1;
  narrow->roi.width = 320;  // as many as the scaled image has
  narrow->roi.height = 480;
  EXPECT_TRUE(isTaken(full));
  EXPECT_FALSE(isTaken(binned));
  EXPECT_FALSE(isTaken(shifted));
  EXPECT_FALSE(isTaken(narrow));
}

/// One camera of 1280x960 px and one of 640x480 see the same flight.
class ScaledFlight : public testing::Test {
 protected:
  static sim::Simulation flight(double image_scale) {
    sim::SimulationOptions options;
    options.scene = "wall";
    options.seed = 1;
    options.rate_hz = 1.5;
    options.image_scale = image_scale;
    return sim::Simulation(options);
  }

  struct Node {
    explicit Node(double scale) : config(makeConfig({{"ros/scale", scale}})) {}
    const NodeConfig config;
    Transforms transforms;
    Inbox inbox;
    Processor processor{config, transforms, inbox};
  };

  static StereoMessages messages(const sim::Simulation& flight, std::size_t index) {
    const StereoFrame frame = flight.frame(index);
    const StereoCalibration& rig = flight.calibration();
    std_msgs::Header header;
    header.stamp = ros::Time(frame.stamp_s);
    header.frame_id = "left_optical";
    return {toImage(header, frame.left, "mono8"), cameraInfo(rig, rig.cx_px, 0.0),
            toImage(header, frame.right, "mono8"), cameraInfo(rig, rig.cx_right_px, rig.baseline_m)};
  }
};

TEST_F(ScaledFlight, AtHalfScaleHasTheVerdictsOfTheSmallerCamera) {
  // A verdict may be off by one cell and 3 % of range: within that of the corridor's end either one is right.
  const double length_m = CorridorConfig().length_m, band_m = MapConfig().resolution_m + 0.03 * length_m;
  const sim::Simulation fine = flight(2.0), coarse = flight(1.0);
  Node half(0.5), full(1.0);
  int free = 0, blocked = 0;
  for (std::size_t i = 0; i < coarse.frameTimes().size(); ++i) {
    const Verdict expected = full.processor.process(messages(coarse, i)).verdict;
    const Verdict verdict = half.processor.process(messages(fine, i)).verdict;
    ASSERT_EQ(half.processor.left().size(), full.processor.left().size());
    ASSERT_EQ(half.processor.leftInfo()->width, full.processor.leftInfo()->width);
    const sim::CorridorTruth truth = coarse.truth(i);
    if (std::abs(truth.clear_exact_m - length_m) <= band_m) continue;
    EXPECT_EQ(verdict.state, expected.state)
        << i << ": " << describeReasons(verdict.reasons) << ", not " << describeReasons(expected.reasons);
    free += verdict.state == State::Free;
    blocked += verdict.state == State::Blocked;
  }
  EXPECT_GE(free, 3);
  EXPECT_GE(blocked, 2);
}

TEST_F(ScaledFlight, ImagesThatDoNotFitTheirCameraInfoAreRefused) {
  const sim::Simulation small = flight(1.0);
  StereoMessages pair = messages(small, 0);
  const StereoMessages announced = messages(flight(2.0), 0);
  pair.left_info = announced.left_info;
  pair.right_info = announced.right_info;
  Node half(0.5);
  EXPECT_EQ(half.processor.process(pair).verdict.reasons & kBadImage, kBadImage);
}

}  // namespace
}  // namespace flight_corridor_ros
