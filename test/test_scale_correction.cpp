#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/range/scale_correction.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

using test_support::kVgaGeometry;

/// Shows a rig with true = a * measured + b surfaces between two depths, 30 times a second.
void teach(ScaleCorrection& scale, double a, double b_px, double from_m, double to_m, int frames) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 0.2);
  for (int i = 0; i < frames; ++i) {
    const double true_px = kVgaGeometry.disparity(from_m + (to_m - from_m) * i / frames);
    scale.update(i / 30.0, (true_px - b_px) / a + noise(random), true_px, 0.2, 0.0);
  }
}

double depthError(const ScaleCorrection& scale, double a, double b_px, double depth_m) {
  const double true_px = kVgaGeometry.disparity(depth_m);
  return std::abs(kVgaGeometry.depth(scale.correct((true_px - b_px) / a)) / depth_m - 1.0);
}

TEST(ScaleCorrection, WithoutEvidenceNothingIsCorrected) {
  const ScaleCorrection scale((ScaleConfig()));
  EXPECT_DOUBLE_EQ(scale.correct(10.0), 10.0);
  EXPECT_DOUBLE_EQ(scale.scale(10.0), 1.0);
  EXPECT_TRUE(std::isnan(scale.correct(kNaN)));
}

TEST(ScaleCorrection, LearnsScaleAndOffsetFromAVaryingRange) {
  for (const double a : {0.92, 1.0, 1.08}) {
    for (const double b_px : {-0.5, 0.0, 0.5}) {
      ScaleCorrection scale((ScaleConfig()));
      teach(scale, a, b_px, 6.0, 1.5, 90);
      for (const double depth_m : {1.5, 3.0, 5.0}) {
        // 90 readings of 0.2 px: about 0.05 px at the far end, 0.6 % of 8.4 px at 5 m; three sigma.
        EXPECT_LT(depthError(scale, a, b_px, depth_m), 0.02) << "a " << a << " b " << b_px << " at " << depth_m;
      }
    }
  }
}

TEST(ScaleCorrection, WhatChanceExplainsIsNotApplied) {
  for (const double bias_px : {-0.03, 0.0, 0.03}) {  // of all matches of the surface, however long it is looked at
    ScaleCorrection scale((ScaleConfig()));
    teach(scale, 1.0, bias_px, 6.0, 2.0, 900);
    for (double disparity_px = 5.0; disparity_px < 30.0; disparity_px += 5.0) {
      EXPECT_EQ(scale.correct(disparity_px), disparity_px) << "bias " << bias_px;
    }
  }
}

TEST(ScaleCorrection, WhatBecomesSignificantDoesNotJump) {
  // A rig that slowly loses its calibration, 1 % in 10 s: no pair may move a surface at 4 m by more than 0.5 %.
  ScaleCorrection scale((ScaleConfig()));
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.03);
  const double reference_px = kVgaGeometry.disparity(4.0);
  double before = scale.scale(reference_px);
  for (int i = 0; i < 1800; ++i) {
    const double true_px = kVgaGeometry.disparity(4.0 + 2.0 * std::sin(i / 30.0)), a = 1.0 + 0.001 * i / 30.0;
    scale.update(i / 30.0, true_px / a + noise(random), true_px, 0.1, 0.02);
    EXPECT_NEAR(scale.scale(reference_px), before, 0.005) << "after " << i / 30.0 << " s";
    before = scale.scale(reference_px);
  }
  EXPECT_NEAR(before, 1.0 / 1.06, 0.02);
}

TEST(ScaleCorrection, OneReadingMovesItNoFurtherThanTheBound) {
  ScaleConfig config;
  config.prior_sigma = 1.0;
  ScaleCorrection scale(config);
  scale.update(0.0, 10.0, 8.7, 0.01, 0.0);
  for (double disparity = 0.1; disparity < 128; disparity *= 1.5) {
    EXPECT_LE(scale.scale(disparity), 1.0 + config.max_correction + 1e-12);
    EXPECT_GE(scale.scale(disparity), 1.0 - config.max_correction - 1e-12);
  }
}

TEST(ScaleCorrection, AnAbsurdPairTeachesNothing) {
  ScaleCorrection scale((ScaleConfig()));
  EXPECT_FALSE(
      scale.update(0.0, kVgaGeometry.disparity(3.0), kVgaGeometry.disparity(12.0), 0.3, 0.0));  // stuck LiDAR, + 9 m
  EXPECT_FALSE(scale.update(0.0, kNaN, 10.0, 0.3, 0.0));
  EXPECT_FALSE(scale.update(0.0, 10.0, kInfinity, 0.3, 0.0));
  EXPECT_FALSE(scale.update(0.0, 10.0, 10.0, 0.0, 0.0));
  EXPECT_DOUBLE_EQ(scale.correct(10.0), 10.0);
}

TEST(ScaleCorrection, AHoverTeachesNothingOfOtherRanges) {
  // Two minutes before one surface, faultless: noise alone must not move what is nearer outwards by over 2 %.
  for (const double hover_m : {5.0, 8.0, 12.0}) {
    ScaleCorrection scale((ScaleConfig()));
    std::mt19937 random(9);
    std::normal_distribution<double> noise(0.0, 0.1);
    const double true_px = kVgaGeometry.disparity(hover_m);
    for (int i = 0; i < 3600; ++i) scale.update(i / 30.0, true_px + noise(random), true_px, 0.3, 0.02);
    EXPECT_LT(scale.scale(kVgaGeometry.disparity(4.0)), 1.02) << hover_m;
    EXPECT_GT(scale.scale(kVgaGeometry.disparity(4.0)), 0.95) << hover_m;
  }
}

TEST(ScaleCorrection, LearnsFurtherInwardsThanOutwards) {
  ScaleCorrection inwards((ScaleConfig())), outwards((ScaleConfig()));
  EXPECT_TRUE(inwards.update(0.0, 6.0, 7.4, 0.3, 0.0));
  EXPECT_FALSE(outwards.update(0.0, 6.0, 4.6, 0.3, 0.0));
}

TEST(ScaleCorrection, LearnsTheOffsetOfARigThatIsKnockedAfterTenMinutes) {
  ScaleCorrection scale((ScaleConfig()));
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.1);
  constexpr double kKnocked_s = 600.0, kKnock_px = 0.5;
  for (double stamp_s = 0.0; stamp_s < kKnocked_s + 180.0; stamp_s += 0.1) {
    const double true_px = kVgaGeometry.disparity(4.0 + 2.0 * std::sin(stamp_s));
    const double offset_px = stamp_s < kKnocked_s ? 0.0 : kKnock_px;
    scale.update(stamp_s, true_px - offset_px + noise(random), true_px, 0.1, 0.0);
  }
  EXPECT_NEAR(scale.correct(10.0), 10.0 + kKnock_px, 0.1);
}

TEST(ScaleCorrection, WhatIsForgottenIsNoLessCertainThanAtFirst) {
  ScaleCorrection scale((ScaleConfig()));
  const double before = scale.sigma(20.0);
  teach(scale, 1.0, 0.0, 6.0, 2.0, 60);
  scale.forgetUntil(1e6);
  EXPECT_LE(scale.sigma(20.0), 1.0001 * before);
}

TEST(ScaleCorrection, ASpikeAfterConvergenceIsGated) {
  ScaleCorrection scale((ScaleConfig()));
  teach(scale, 1.03, 0.0, 6.0, 2.0, 60);
  EXPECT_FALSE(scale.update(2.1, 20.0, 1.03 * 20.0 * 1.1, 0.2, 0.0));
  EXPECT_TRUE(scale.update(2.1, 20.0, 1.03 * 20.0, 0.2, 0.0));
}

TEST(ScaleCorrection, EvidenceShrinksItsSigmaAndTimeWidensItAgain) {
  ScaleCorrection scale((ScaleConfig()));
  const double before = scale.sigma(20.0);
  teach(scale, 1.0, 0.0, 6.0, 2.0, 60);
  const double learnt = scale.sigma(20.0);
  EXPECT_LT(learnt, 0.2 * before);
  scale.update(100.0, 20.0, 20.0, 100.0, 0.0);  // a pair that says nothing, long after
  EXPECT_GT(scale.sigma(20.0), learnt);
}

TEST(ScaleCorrection, SwitchedOffItLeavesDisparityAlone) {
  ScaleConfig config;
  config.enabled = false;
  ScaleCorrection scale(config);
  teach(scale, 1.05, 0.0, 6.0, 2.0, 30);
  EXPECT_DOUBLE_EQ(scale.correct(10.0), 10.0);
}

TEST(ScaleCorrection, DepthIsOfTheCorrectedDisparity) {
  ScaleCorrection scale((ScaleConfig()));
  for (int i = 0; i < 50; ++i) scale.update(i, 10.0, 10.5, 0.05, 0.0);
  cv::Mat disparity_px(kVgaGeometry.size(), CV_32FC1, cv::Scalar(10.0)), depth_m;
  disparity_px.at<float>(1, 1) = static_cast<float>(kNaN);
  correctedDepth(disparity_px, scale, kVgaGeometry, depth_m);
  EXPECT_NEAR(depth_m.at<float>(100, 100), kVgaGeometry.depth(scale.correct(10.0)), 1e-6);
  EXPECT_LT(depth_m.at<float>(100, 100), kVgaGeometry.depth(10.2));
  EXPECT_TRUE(std::isnan(depth_m.at<float>(1, 1)));
}

}  // namespace
}  // namespace flight_corridor
