#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "flight_corridor/view/evidence.hpp"
#include "support/calibrations.hpp"
#include "support/parallel_wires.hpp"
#include "support/wall_scene.hpp"

namespace flight_corridor {
namespace {

using test_support::wallFrame;

cv::Mat evidenceOf(const StereoFrame& frame, const StereoGeometry& geometry) {
  Pipeline pipeline(Config(), geometry, Rig());
  pipeline.process(frame);
  return evidenceOf(pipeline);
}

/// Of the pixels about the corridor.
double share(const cv::Mat& evidence, Evidence kind) {
  return static_cast<double>(cv::countNonZero(evidence == static_cast<int>(kind))) /
         cv::countNonZero(evidence != static_cast<int>(Evidence::Outside));
}

TEST(EvidenceView, NothingBeforeTheFirstPair) {
  const Pipeline pipeline(Config(), StereoGeometry(test_support::smallCalibration()), Rig());
  EXPECT_TRUE(evidenceOf(pipeline).empty());
  cv::Mat drawn;
  drawEvidence(pipeline.left(), evidenceOf(pipeline), drawn);
  EXPECT_TRUE(drawn.empty());
}

TEST(EvidenceView, AWallBehindTheCorridorIsClearAndOneInItIsMatched) {
  const StereoGeometry geometry(test_support::smallCalibration());
  const cv::Mat behind = evidenceOf(wallFrame(geometry, 3, 1.0), geometry);
  EXPECT_GT(share(behind, Evidence::Clear), 0.9);
  EXPECT_EQ(share(behind, Evidence::InBox), 0.0);
  EXPECT_EQ(behind.at<std::uint8_t>(0, 0), static_cast<std::uint8_t>(Evidence::Outside));  // above the corridor
  EXPECT_GT(share(evidenceOf(wallFrame(geometry, 7, 1.0), geometry), Evidence::InBox), 0.01);
}

TEST(EvidenceView, WhatShowsNothingIsTexturelessAndAHole) {
  const StereoGeometry geometry(test_support::smallCalibration());
  StereoFrame frame = wallFrame(geometry, 3, 1.0);
  frame.left = cv::Scalar(90);
  frame.right = cv::Scalar(91);
  const cv::Mat evidence = evidenceOf(frame, geometry);
  EXPECT_EQ(share(evidence, Evidence::Clear), 0.0);
  EXPECT_GT(share(evidence, Evidence::Hole), 0.0);
  EXPECT_GT(share(evidence, Evidence::Textureless), 0.1);
}

TEST(EvidenceView, WhatIsNearerThanStereoSeesIsNotUnclear) {
  StereoCalibration calibration = test_support::smallCalibration();
  calibration.baseline_m *= 2.0;
  const StereoGeometry geometry(calibration);
  EXPECT_GT(share(evidenceOf(wallFrame(geometry, 6, 1.0), geometry), Evidence::Clear), 0.9);
}

TEST(EvidenceView, WiresThatFitOnEachOtherAreDoubtful) {
  const test_support::ParallelWires wires;
  EXPECT_GT(share(evidenceOf(wires.frame, wires.geometry), Evidence::Doubtful), 0.0);
}

TEST(EvidenceView, EachKindHasItsOwnColour) {
  const int kinds = static_cast<int>(Evidence::InBox) + 1;
  cv::Mat evidence(1, kinds, CV_8UC1), drawn;
  for (int i = 0; i < kinds; ++i) evidence.at<std::uint8_t>(i) = static_cast<std::uint8_t>(i);
  drawEvidence(cv::Mat(evidence.size(), CV_8UC1, 100), evidence, drawn);
  for (int i = 0; i < kinds; ++i) {
    for (int j = 0; j < i; ++j) EXPECT_GT(cv::norm(drawn.at<cv::Vec3b>(i), drawn.at<cv::Vec3b>(j)), 30.0) << i << j;
  }
}

}  // namespace
}  // namespace flight_corridor
