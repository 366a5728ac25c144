#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "../bench/paper_rule.hpp"
#include "support/calibrations.hpp"
#include "support/range_trace.hpp"

namespace flight_corridor::bench {
namespace {

using test_support::kVgaGeometry;  // f 350 px, f*B 42 px m
using test_support::paperSettings;

const CorridorConfig kCorridor;  // 1.2 m x 0.4 m at 4 m

cv::Mat wall(double depth_m) { return {kVgaGeometry.size(), CV_32FC1, cv::Scalar(kVgaGeometry.disparity(depth_m))}; }

PaperRule rule() { return {kCorridor, LidarConfig(), paperSettings()}; }

TEST(PaperRule, TheWindowIsTheCorridorsFaceAtItsEnd) {
  const cv::Rect window = paperWindow(kCorridor, kVgaGeometry);
  EXPECT_NEAR(window.width, 350.0 * 1.2 / 4.0, 1.0);  // two rounded edges
  EXPECT_NEAR(window.height, 350.0 * 0.4 / 4.0, 1.0);
  EXPECT_NEAR(window.x + 0.5 * window.width, 319.5, 1.0);
  EXPECT_NEAR(window.y + 0.5 * window.height, 239.5, 1.0);
}

TEST(PaperRule, TheDepthIsTheMeanOfWhatHasADisparityInTheWindow) {
  const cv::Rect window(100, 100, 40, 20);
  cv::Mat disparity_px = wall(1.0);
  disparity_px(window) = kVgaGeometry.disparity(2.0);
  disparity_px(cv::Rect(100, 100, 20, 20)) = kVgaGeometry.disparity(6.0);
  EXPECT_NEAR(meanDepth(disparity_px, window, kVgaGeometry), 4.0, 1e-6);  // disparities are floats
  disparity_px(cv::Rect(100, 100, 20, 20)) = -1.0;
  EXPECT_NEAR(meanDepth(disparity_px, window, kVgaGeometry), 2.0, 1e-6);
  disparity_px(window) = kNaN;
  EXPECT_TRUE(std::isnan(meanDepth(disparity_px, window, kVgaGeometry)));
}

TEST(PaperRule, RangeAndDepthOfOneMomentAreWeightedByTheirVariances) {
  PaperRule paper = rule();
  paper.addRange({0.0, 5.0});
  const PaperVerdict verdict = paper.judge(0.0, wall(6.0), kVgaGeometry);
  const double lidar_1pm2 = 1.0 / paperSettings().lidar_variance_m2,
               stereo_1pm2 = 1.0 / paperSettings().stereo_variance_m2;
  EXPECT_NEAR(verdict.stereo_m, 6.0, 1e-6);  // disparities are floats
  EXPECT_EQ(verdict.lidar_m, 5.0);
  EXPECT_NEAR(verdict.fused_m, (5.0 * lidar_1pm2 + 6.0 * stereo_1pm2) / (lidar_1pm2 + stereo_1pm2), 1e-6);
}

TEST(PaperRule, IsFreeFromDMinOn) {
  for (const double depth_m : {3.9, 4.1}) {
    PaperRule paper = rule();
    paper.addRange({0.0, depth_m});
    EXPECT_EQ(paper.judge(0.0, wall(depth_m), kVgaGeometry).state, depth_m < 4.0 ? State::Blocked : State::Free);
  }
}

TEST(PaperRule, WithoutALidarStereoAnswersFromTheSecondPairOn) {
  PaperRule paper = rule();
  EXPECT_EQ(paper.judge(0.0, wall(3.0), kVgaGeometry).state, State::Unknown) << "a lone reading is no range yet";
  const PaperVerdict verdict = paper.judge(0.1, wall(3.0), kVgaGeometry);
  EXPECT_EQ(verdict.state, State::Blocked);
  EXPECT_NEAR(verdict.fused_m, 3.0, 1e-6);
  EXPECT_TRUE(std::isnan(verdict.lidar_m));
}

TEST(PaperRule, AReadingBeyondTheLidarsLimitsIsNoRange) {
  PaperRule paper = rule();
  paper.addRange({0.0, kInfinity});
  paper.addRange({0.01, 0.1});  // LidarConfig's minimum is 0.2
  const PaperVerdict verdict = paper.judge(0.02, wall(3.0), kVgaGeometry);
  EXPECT_TRUE(std::isnan(verdict.lidar_m));
  EXPECT_EQ(verdict.state, State::Unknown);
}

TEST(PaperRule, AnObstacleThatCoversLessThanTheWindowIsAveragedAway) {
  PaperRule paper = rule();
  cv::Mat disparity_px = wall(10.0);
  const cv::Rect window = paperWindow(kCorridor, kVgaGeometry);
  disparity_px(cv::Rect(window.tl(), cv::Size(window.width / 4, window.height))) = kVgaGeometry.disparity(2.0);
  paper.addRange({0.0, 10.0});
  EXPECT_EQ(paper.judge(0.0, disparity_px, kVgaGeometry).state, State::Free);
}

}  // namespace
}  // namespace flight_corridor::bench
