#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
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

/// Matches as the CPU does; then something happens to the planes.
class FakeMatcher : public DeviceMatcher {
 public:
  using Change = std::function<void(const MatchPlanes&)>;

  FakeMatcher(const MatcherSize& size, Change change)
      : workers_(1), matcher_(size, workers_), change_(std::move(change)) {}

  std::string name() const override { return "a GPU"; }
  void match(const GreyImage& left, const GreyImage& right, const MatchPlanes& out) override {
    matcher_.match(left, right, out);
    change_(out);
  }

 private:
  BandWorkers workers_;
  SemiGlobalMatcher matcher_;
  Change change_;
};

DeviceMatcherFactory fakes(const FakeMatcher::Change& change) {
  return [change](const MatcherSize& size) { return std::make_unique<FakeMatcher>(size, change); };
}

const DeviceMatcherFactory kNone = [](const MatcherSize&) { return nullptr; };
const DeviceMatcherFactory kBroken = [](const MatcherSize&) -> std::unique_ptr<DeviceMatcher> {
  throw DeviceError("broken");
};

StereoConfig onDevice(const std::string& device) {
  StereoConfig config;
  config.device = device;
  return config;
}

MatchingDevice deviceOf(const char* device, const DeviceMatcherFactory& make) {
  return DisparityEstimator(onDevice(device), test_support::kSmallGeometry, kSmallest_m, make).device();
}

TEST(DisparityEstimator, MatchesOnTheCpuOnceTheDeviceHasFailed) {
  const StereoGeometry geometry(smallCalibration());
  const StereoFrame frame = wallFrame(geometry, 12, 0.0);
  int good_pairs = 2;  // the sample and one more
  DisparityEstimator estimator(onDevice("gpu"), geometry, kSmallest_m, fakes([&](const MatchPlanes&) {
                                 if (--good_pairs < 0) throw DeviceError("it is gone");
                               }));
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
  EXPECT_EQ(deviceOf("cpu", kBroken).failure, "");
  EXPECT_EQ(deviceOf("auto", kNone).failure, "");
  EXPECT_EQ(deviceOf("auto", kBroken).failure, "broken");
  EXPECT_EQ(deviceOf("auto", {}).failure, "");
  EXPECT_EQ(deviceOf("gpu", {}).failure, "this program matches on the CPU only");
  EXPECT_EQ(deviceOf("gpu", kNone).failure, "OpenCL finds no GPU: install its driver with OpenCL (clinfo lists it)");
  EXPECT_EQ(deviceOf("gpu", kBroken).failure, "broken");
}

TEST(DisparityEstimator, DoesWithoutADeviceOfWhoseSampleOnePixelDiffers) {
  constexpr std::size_t kPixel = 320 * 240 - 1;
  const FakeMatcher::Change changes[] = {
      [](const MatchPlanes& out) { out.best[kPixel] = 3.3f; },
      [](const MatchPlanes& out) { out.repeated[kPixel] = 3.3f; },
      [](const MatchPlanes& out) { out.competitor_farthest[kPixel] ^= 1; },
      [](const MatchPlanes& out) { out.competitor_nearest[kPixel] ^= 1; },
      [](const MatchPlanes& out) { out.flags[kPixel] ^= kDistinct; },
      [](const MatchPlanes& out) { out.set[kPixel * 2 + 1] ^= 1; },  // two words a pixel
  };
  for (const FakeMatcher::Change& change : changes) {
    const MatchingDevice device = deviceOf("auto", fakes(change));
    EXPECT_EQ(device.name, "CPU") << &change - changes;
    EXPECT_EQ(device.failure, "OpenCL: the device finds other matches than the CPU");
  }
}

TEST(DisparityEstimator, ADeviceMayHaveANaNOfItsOwn) {
  const auto negate = [](const MatchPlanes& out) {
    for (int i = 0; i < 320 * 240; ++i) {
      if (std::isnan(out.best[i])) out.best[i] = -out.best[i];
    }
  };
  EXPECT_EQ(deviceOf("auto", fakes(negate)).failure, "");
}

TEST(DisparityEstimator, TheSampleHasEveryKindOfMatch) {
  int best = 0, repeated = 0, quarters[4] = {}, flags[16] = {};
  const auto count = [&](const MatchPlanes& out) {
    for (int i = 0; i < 320 * 240; ++i) {
      best += std::fmod(out.best[i], 1.0f) > 0.0f;
      repeated += std::fmod(out.repeated[i], 1.0f) > 0.0f;
      if (out.best[i] >= 0.0f) ++quarters[static_cast<int>(out.best[i]) / 32];
      ++flags[out.flags[i]];
    }
  };
  EXPECT_EQ(deviceOf("gpu", fakes(count)).name, "a GPU");
  EXPECT_GT(best, 10000);
  EXPECT_GT(repeated, 1000);
  for (const int matches : quarters) EXPECT_GT(matches, 1000) << "of 128 disparities";
  constexpr int kMatch = kConsistent | kDistinct;
  for (const int kind : {0, +kConsistent, kMatch, kMatch | kCompetitor, kMatch | kCompetitor | kRepeated}) {
    EXPECT_GT(flags[kind], 1000) << kind;
  }
}

TEST(DisparityEstimator, ADeviceWithoutANameIsNotUsed) {
  struct Nameless : FakeMatcher {
    using FakeMatcher::FakeMatcher;
    std::string name() const override { throw DeviceError("no name"); }
  };
  int pairs = 0;
  const StereoGeometry geometry(smallCalibration());
  DisparityEstimator estimator(onDevice("auto"), geometry, kSmallest_m, [&](const MatcherSize& size) {
    return std::make_unique<Nameless>(size, [&](const MatchPlanes&) { ++pairs; });
  });
  Disparity disparity;
  estimator.estimate(wallFrame(geometry, 12, 0.0), disparity);
  EXPECT_EQ(pairs, 1);  // the sample
  EXPECT_EQ(estimator.device().name, "CPU");
  EXPECT_EQ(estimator.device().failure, "no name");
}

TEST(DisparityEstimator, AGpuThatWasAskedForIsRequired) {
  const auto refusal = [](const char* device, const DeviceMatcherFactory& make) -> std::string {
    try {
      requireDevice(onDevice(device), make);
      return "";
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refusal("cpu", kBroken), "");
  EXPECT_EQ(refusal("auto", kBroken), "");
  EXPECT_EQ(refusal("gpu", fakes([](const MatchPlanes&) {})), "");
  EXPECT_EQ(refusal("gpu", kBroken), "stereo/device: gpu: broken. Choose cpu or auto without one");
  EXPECT_EQ(refusal("gpu", fakes([](const MatchPlanes& out) { out.flags[0] ^= kDistinct; })),
            "stereo/device: gpu: OpenCL: the device finds other matches than the CPU. Choose cpu or auto without one");
}

}  // namespace
}  // namespace flight_corridor
