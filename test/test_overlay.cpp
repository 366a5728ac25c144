#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "flight_corridor/view/overlay.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

using test_support::kVgaGeometry;

Box boxAhead() {
  Box box;
  box.T_M_F = opticalFromForward();
  box.size_m = {4.0, 1.2, 0.4};
  return box;
}

cv::Vec3b pixelOfWindow(State state, double clear_distance_m, int u, int v) {
  Verdict verdict;
  verdict.state = state;
  verdict.clear_distance_m = clear_distance_m;
  cv::Mat out;
  drawOverlay(cv::Mat(kVgaGeometry.size(), CV_8UC1, cv::Scalar(100)), {}, kVgaGeometry, boxAhead(), verdict,
              RangeEstimate(), out);
  return out.at<cv::Vec3b>(v, u);
}

TEST(Overlay, TheWindowBearsTheStatesColour) {
  const cv::Vec3b free = pixelOfWindow(State::Free, kInfinity, 320, 240);
  const cv::Vec3b blocked = pixelOfWindow(State::Blocked, 3.0, 320, 240);
  const cv::Vec3b unknown = pixelOfWindow(State::Unknown, kInfinity, 320, 240);
  EXPECT_GT(free[1], free[2]);        // green
  EXPECT_GT(blocked[2], blocked[1]);  // red
  EXPECT_GT(unknown[2], unknown[0]);  // amber: red and green, no blue
  EXPECT_GT(unknown[1], unknown[0]);
}

TEST(Overlay, TheWindowStandsWhereTheCorridorEnds) {
  // 0.6 m to the side is column 372 at 4 m and column 425 at 2 m.
  const cv::Vec3b background(100, 100, 100);
  EXPECT_EQ(pixelOfWindow(State::Free, kInfinity, 400, 250), background);
  EXPECT_NE(pixelOfWindow(State::Blocked, 2.0, 400, 250), background);
}

TEST(Overlay, OwnPartsAreHatchedInBlackAndWhite) {
  cv::Mat covered = cv::Mat::zeros(kVgaGeometry.size(), CV_8UC1), out;
  const cv::Rect part(20, 210, 60, 60);  // no line or text there
  covered(part) = 255;
  drawOverlay(cv::Mat(kVgaGeometry.size(), CV_8UC1, cv::Scalar(100)), covered, kVgaGeometry, boxAhead(), Verdict(),
              RangeEstimate(), out);
  cv::Mat white, black;
  cv::inRange(out, cv::Scalar::all(255), cv::Scalar::all(255), white);
  cv::inRange(out, cv::Scalar::all(0), cv::Scalar::all(0), black);
  for (const cv::Mat& line : {white, black}) {
    EXPECT_EQ(cv::countNonZero(line(part)), part.area() / 6);
    EXPECT_EQ(cv::countNonZero(line(cv::Rect(80, 210, 60, 60))), 0);
  }
}

TEST(Overlay, DepthIsBlackWhereThereIsNone) {
  cv::Mat depth(64, 64, CV_32FC1, cv::Scalar(3.0)), out;  // wide enough for vector code
  depth.at<float>(0, 0) = static_cast<float>(kNaN);
  drawDepth(depth, 8.0, out);
  EXPECT_EQ(out.at<cv::Vec3b>(0, 0), cv::Vec3b(0, 0, 0));
  EXPECT_NE(out.at<cv::Vec3b>(1, 1), cv::Vec3b(0, 0, 0));
}

TEST(Overlay, TheMapFromAboveShowsAnObstacleAheadAboveTheMiddle) {
  octomap::OcTree tree(0.1);
  tree.setNodeValue(octomap::point3d(4.05f, 0.05f, 0.05f), 1.0f);
  tree.setNodeValue(octomap::point3d(1.05f, 0.05f, 0.05f), -1.0f);
  Box box = boxAhead();
  box.T_M_F = Eigen::Isometry3d::Identity();
  cv::Mat out;
  drawMapFromAbove(tree, box, Verdict(), 8.0, {320, 320}, out);  // 40 px a metre
  const cv::Vec3b occupied = out.at<cv::Vec3b>(320 - 162, 160 - 2), free = out.at<cv::Vec3b>(320 - 42, 160 - 2);
  EXPECT_LT(occupied[0], 60);
  EXPECT_GT(free[0], 200);
}

TEST(Overlay, ABoxThatReachesBehindTheCameraIsDrawnWithoutHarm) {
  Box box = boxAhead();
  box.T_M_F.translation().z() = -3.0;
  Verdict verdict;
  cv::Mat out;
  drawOverlay(cv::Mat(kVgaGeometry.size(), CV_8UC3, cv::Scalar::all(9)), {}, kVgaGeometry, box, verdict,
              RangeEstimate(), out);
  EXPECT_EQ(out.size(), kVgaGeometry.size());
}

TEST(Overlay, TheLineOfVerdictsFillsFromTheLeft) {
  cv::Mat out;
  drawVerdicts({State::Free, State::Blocked}, 4, {40, 6}, out);
  const auto at = [&](int column) { return cv::Scalar(out.at<cv::Vec3b>(3, column)); };
  EXPECT_EQ(at(0), colour(State::Free));
  EXPECT_EQ(at(9), colour(State::Free));
  EXPECT_EQ(at(10), colour(State::Blocked));
  EXPECT_EQ(at(19), colour(State::Blocked));
  EXPECT_EQ(at(20), cv::Scalar());
  EXPECT_EQ(at(39), cv::Scalar());
}

}  // namespace
}  // namespace flight_corridor
