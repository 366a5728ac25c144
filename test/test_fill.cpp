#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "flight_corridor/view/fill.hpp"

namespace flight_corridor {
namespace {

const cv::Size kImage(200, 120);

TEST(Fill, KeepsMatchesAndBridgesGaps) {
  cv::Mat left(kImage, CV_8UC1, cv::Scalar(100)), matched(kImage, CV_32FC1, cv::Scalar(10.0)), filled;
  matched(cv::Rect(80, 50, 12, 12)).setTo(NAN);
  fillDisparity(left, matched, filled);
  EXPECT_NEAR(filled.at<float>(56, 86), 10.0, 0.05);
  EXPECT_EQ(filled.at<float>(10, 10), 10.0f);
}

TEST(Fill, StopsAtTheImagesEdges) {
  cv::Mat left(kImage, CV_8UC1, cv::Scalar(40)), matched(kImage, CV_32FC1, cv::Scalar(5.0)), filled;
  left.colRange(100, 200).setTo(200);
  matched.colRange(100, 200).setTo(20.0);
  matched.colRange(92, 108).setTo(NAN);
  fillDisparity(left, matched, filled);
  EXPECT_NEAR(filled.at<float>(60, 97), 5.0, 1.0);
  EXPECT_NEAR(filled.at<float>(60, 102), 20.0, 1.0);
}

TEST(Fill, InventsNothingFarFromMatches) {
  cv::Mat left(kImage, CV_8UC1, cv::Scalar(100)), matched(kImage, CV_32FC1, cv::Scalar(NAN)), filled;
  fillDisparity(left, matched, filled);
  EXPECT_EQ(cv::countNonZero(filled == filled), 0);
}

}  // namespace
}  // namespace flight_corridor
