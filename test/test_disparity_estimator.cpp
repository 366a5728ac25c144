#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "flight_corridor/stereo/disparity_estimator.hpp"
#include "support/calibrations.hpp"
#include "support/corridor_box.hpp"
#include "support/wall_scene.hpp"

namespace flight_corridor {
namespace {

using test_support::kSmallest_m;
using test_support::smallCalibration;
using test_support::wallFrame;

/// Share of pixels whose disparity lies within a quarter of a pixel of what it should be.
double shareRight(const cv::Mat& disparity_px, double expected_px) {
  const cv::Mat error = cv::abs(disparity_px - expected_px);
  return cv::countNonZero(error <= 0.25) / static_cast<double>(error.total());
}

Disparity estimate(const StereoFrame& frame, const StereoGeometry& geometry) {
  Disparity disparity;
  DisparityEstimator(StereoConfig(), geometry, kSmallest_m).estimate(frame, disparity);
  return disparity;
}

TEST(DisparityEstimator, FindsTheDisparityOfATexturedWall) {
  const StereoGeometry geometry(smallCalibration());
  const Disparity disparity = estimate(wallFrame(geometry, 12, 0.0), geometry);
  // What the right image cannot show (12 of 320 columns) and a block's border are left out.
  EXPECT_GT(shareRight(disparity.best_px, 12.0), 0.90);
  EXPECT_GT(disparity.matched_fraction, 0.90);
}

TEST(DisparityEstimator, CamerasMayExposeDifferently) {
  const StereoGeometry geometry(smallCalibration());
  for (const double gain : {0.5, 0.8, 1.25}) {
    StereoFrame frame = wallFrame(geometry, 12, 0.0);
    frame.left *= 0.7;  // so that nothing is saturated
    frame.right *= 0.7 * gain;
    EXPECT_GT(shareRight(estimate(frame, geometry).best_px, 12.0), 0.90) << gain;
  }
}

TEST(DisparityEstimator, AWhiteSkyHidesNoDifferenceOfExposure) {
  const StereoGeometry geometry(smallCalibration());
  const int horizon = geometry.size().height / 2;
  for (const double gain : {0.6, 1.6}) {
    StereoFrame frame = wallFrame(geometry, 12, 0.0);
    frame.left.convertTo(frame.left, -1, 0.6, 60.0);
    frame.right.convertTo(frame.right, -1, 0.6 * gain, 60.0 * gain);
    frame.left.rowRange(0, horizon).setTo(255);
    frame.right.rowRange(0, horizon).setTo(255);
    const Disparity disparity = estimate(frame, geometry);
    EXPECT_GT(shareRight(disparity.best_px.rowRange(horizon, disparity.best_px.rows), 12.0), 0.94) << gain;
  }
}

TEST(DisparityEstimator, RemovesThePrincipalPointDifferenceOnce) {
  for (const double difference_px : {-20.0, 7.0, 40.0}) {
    StereoCalibration calibration = smallCalibration();
    calibration.cx_right_px = calibration.cx_px - difference_px;
    const StereoGeometry geometry(calibration);
    EXPECT_GT(shareRight(estimate(wallFrame(geometry, 30, 0.0), geometry).best_px, 30.0), 0.70)
        << "cx_l - cx_r = " << difference_px;
  }
}

TEST(DisparityEstimator, TheLeftStripIsMatchedAsFarAsTheRightImageShowsIt) {
  const StereoGeometry geometry(smallCalibration());
  const Disparity disparity = estimate(wallFrame(geometry, 8, 0.0), geometry);
  EXPECT_GT(shareRight(disparity.best_px.colRange(16, 120), 8.0), 0.9);  // the search range is 128 px
  EXPECT_EQ(cv::countNonZero(disparity.best_px.colRange(0, 4) > 4.0), 0);
}

TEST(DisparityEstimator, BlankImagesGiveNoDisparity) {
  const StereoGeometry geometry(smallCalibration());
  StereoFrame frame;
  frame.left = frame.right = cv::Mat(geometry.size(), CV_8UC1, cv::Scalar(255));
  EXPECT_EQ(estimate(frame, geometry).matched_fraction, 0.0);
}

TEST(DisparityEstimator, TheSameFrameGivesTheSameDisparity) {
  const StereoGeometry geometry(smallCalibration());
  DisparityEstimator one(StereoConfig(), geometry, kSmallest_m), other(StereoConfig(), geometry, kSmallest_m);
  Disparity a, b;
  other.estimate(wallFrame(geometry, 40, 0.0), b);  // leaves its scratch images behind
  one.estimate(wallFrame(geometry, 9, 0.0), a);
  other.estimate(wallFrame(geometry, 9, 0.0), b);
  EXPECT_EQ(cv::countNonZero(a.best_px == b.best_px), cv::countNonZero(a.best_px == a.best_px));
  EXPECT_EQ(cv::countNonZero(b.best_px == b.best_px), cv::countNonZero(a.best_px == a.best_px));
}

TEST(DisparityEstimator, MatchesFarBelowZeroAreWrongAndALittleBelowTheyAreFar) {
  const StereoGeometry geometry(smallCalibration());
  const cv::Point middle(geometry.size() / 2);
  for (const int below_px : {1, 2}) {
    StereoFrame wall = wallFrame(geometry, below_px, 1.0);
    std::swap(wall.left, wall.right);
    const float matched_px = estimate(wall, geometry).best_px.at<float>(middle);
    if (below_px == 1) {
      EXPECT_EQ(matched_px, 1.0f / 16.0f);
    } else {
      EXPECT_TRUE(std::isnan(matched_px)) << matched_px;
    }
  }
}

TEST(DisparityEstimator, ACoveredLensGivesNoDisparity) {
  const StereoGeometry geometry(smallCalibration());
  DisparityEstimator estimator(StereoConfig(), geometry, kSmallest_m);
  Disparity disparity;
  StereoFrame frame = wallFrame(geometry, 12, 0.0);
  cv::RNG random(3);
  random.fill(frame.right, cv::RNG::NORMAL, 10.0, 1.5);
  estimator.estimate(frame, disparity);
  EXPECT_LT(disparity.matched_fraction, StereoConfig().min_matched_fraction);
  frame.right.setTo(102);  // every disparity costs the same
  estimator.estimate(frame, disparity);
  EXPECT_EQ(disparity.matched_fraction, 0.0);
}

TEST(DisparityEstimator, TwoImagesOfNoiseGiveNoSurface) {
  const StereoGeometry geometry(smallCalibration());
  DisparityEstimator estimator(StereoConfig(), geometry, kSmallest_m);
  Disparity disparity;
  StereoFrame frame;
  cv::RNG random(2);
  for (cv::Mat* image : {&frame.left, &frame.right}) {
    image->create(geometry.size(), CV_8UC1);
    random.fill(*image, cv::RNG::NORMAL, 128.0, 2.0);
  }
  estimator.estimate(frame, disparity);
  EXPECT_LT(disparity.matched_fraction, StereoConfig().min_matched_fraction);
}

TEST(DisparityEstimator, PatchesSmallerThanTheSmallestObstacleAreNoMatches) {
  const StereoGeometry geometry(smallCalibration());
  StereoFrame frame = wallFrame(geometry, 12, 0.0);
  const cv::Rect small(150, 100, 20, 20);
  cv::RNG random(6);
  random.fill(frame.left(small), cv::RNG::UNIFORM, 0, 256);
  frame.left(small).copyTo(frame.right(small - cv::Point(40, 0)));
  for (const double smallest_m : {0.02, 0.2}) {  // the patch covers 0.06 m at 40 px
    Disparity disparity;
    DisparityEstimator(StereoConfig(), geometry, smallest_m).estimate(frame, disparity);
    EXPECT_EQ(shareRight(disparity.best_px(small), 40.0) > 0.5, smallest_m < 0.05) << smallest_m;
  }
}

TEST(DisparityEstimator, RefusesASearchWiderThanTheImage) {
  StereoConfig config;
  config.num_disparities_px = 320;
  EXPECT_THROW(DisparityEstimator(config, StereoGeometry(smallCalibration()), kSmallest_m), std::invalid_argument);
}

TEST(DisparityEstimator, RefusesMoreDisparitiesThanAByteNumbers) {
  StereoConfig config;
  config.num_disparities_px = 288;
  EXPECT_EQ(check(config).size(), 1u);
}

/// Matches some pairs as the CPU does, and fails from then on.
class FailingMatcher : public DeviceMatcher {
 public:
  FailingMatcher(const MatcherSize& size, int good_pairs)
      : workers_(1), matcher_(size, workers_), good_pairs_(good_pairs) {}

  std::string name() const override { return "a GPU"; }
  void match(const GreyImage& left, const GreyImage& right, const MatchPlanes& out) override {
    if (--good_pairs_ < 0) throw DeviceError("it is gone");
    matcher_.match(left, right, out);
  }

 private:
  BandWorkers workers_;
  SemiGlobalMatcher matcher_;
  int good_pairs_;
};

StereoConfig onDevice(const std::string& device) {
  StereoConfig config;
  config.device = device;
  return config;
}

TEST(DisparityEstimator, MatchesOnTheCpuOnceTheDeviceHasFailed) {
  const StereoGeometry geometry(smallCalibration());
  const StereoFrame frame = wallFrame(geometry, 12, 0.0);
  DisparityEstimator estimator(onDevice("gpu"), geometry, kSmallest_m,
                               [](const MatcherSize& size) { return std::make_unique<FailingMatcher>(size, 1); });
  const Disparity alone = estimate(frame, geometry);
  for (const bool has_failed : {false, true, true}) {
    Disparity disparity;
    estimator.estimate(frame, disparity);
    EXPECT_EQ(cv::norm(disparity.set, alone.set, cv::NORM_INF), 0.0);
    EXPECT_EQ(disparity.matched_fraction, alone.matched_fraction);
    EXPECT_EQ(estimator.device().name, has_failed ? "CPU" : "a GPU");
    EXPECT_EQ(estimator.device().failure, has_failed ? "it is gone" : "");
  }
}

TEST(DisparityEstimator, DoesWithoutADeviceThatIsNotThereOrCannotBeUsed) {
  const StereoGeometry geometry(smallCalibration());
  const DeviceMatcherFactory none = [](const MatcherSize&) { return nullptr; };
  const DeviceMatcherFactory broken = [](const MatcherSize&) -> std::unique_ptr<DeviceMatcher> {
    throw DeviceError("broken");
  };
  const auto failure = [&](const char* device, const DeviceMatcherFactory& make) {
    return DisparityEstimator(onDevice(device), geometry, kSmallest_m, make).device().failure;
  };
  EXPECT_EQ(failure("cpu", broken), "");
  EXPECT_EQ(failure("auto", none), "");
  EXPECT_EQ(failure("auto", broken), "broken");
  EXPECT_EQ(failure("gpu", none), "there is no GPU");
  EXPECT_EQ(failure("gpu", broken), "broken");
}

}  // namespace
}  // namespace flight_corridor
