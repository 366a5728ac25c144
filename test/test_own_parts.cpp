#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "sim/rig.hpp"
#include "sim/still.hpp"
#include "support/contains.hpp"
#include "support/masonry.hpp"

namespace flight_corridor {
namespace {

using test_support::contains;
using test_support::cubeAt;
using test_support::masonryAt;
using World = std::vector<sim::Primitive>;

constexpr double kLeg_m = 0.5;  // ahead of the camera

std::string complaintAbout(const cv::Mat& mask, const cv::Size& image_px) {
  try {
    coveredPixels({mask, "gear.png"}, image_px);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(OwnParts, NoMaskCoversNothing) { EXPECT_TRUE(coveredPixels({}, {64, 48}).empty()); }

/// A match rests on costs in a window of 7 x 3 px, each of a census window of 9 x 3 px.
TEST(OwnParts, AlsoCoverPixelsBesideThemWhoseMatchRestsOnACoveredOne) {
  cv::Mat mask(48, 64, CV_8UC1, cv::Scalar(255)), expected = cv::Mat::zeros(48, 64, CV_8UC1);
  mask.at<std::uint8_t>(20, 30) = 0;
  expected(cv::Rect(30 - 7, 20 - 2, 15, 5)) = 255;
  EXPECT_EQ(cv::norm(coveredPixels({mask, ""}, mask.size()), expected, cv::NORM_INF), 0.0);
}

TEST(OwnParts, AreRefusedWhereTheMaskDoesNotFit) {
  const cv::Mat view(48, 64, CV_8UC1, cv::Scalar(255));
  EXPECT_EQ(complaintAbout(view, {640, 480}), "stereo/mask gear.png is 64 x 48 px, but the left image is 640 x 480 px");
  EXPECT_TRUE(contains(complaintAbout(0 * view, view.size()), "gear.png covers the whole image"));
  EXPECT_TRUE(contains(complaintAbout(cv::Mat(48, 64, CV_8UC3), view.size()), "gear.png is of OpenCV's type 16"));
}

/// Landing gear: two textured legs, at both sides of the view, in the corridor.
World withLegs(World world) {
  for (const double side : {-1.0, 1.0}) {
    sim::Random random(3, sim::Stream::Scene);
    world.push_back(sim::makeBox({kLeg_m, 0.25 * side, sim::kHeight_m - 0.15}, {0.02, 0.02, 0.3}, sim::bark(random)));
  }
  return world;
}

/// As a user paints it: exactly what is nearer than a metre.
cv::Mat maskOf(const World& world) {
  const sim::Rig rig = sim::defaultRig();
  Eigen::Isometry3d T_W_B = Eigen::Isometry3d::Identity();
  T_W_B.translation() = Eigen::Vector3d(0.0, 0.0, sim::kHeight_m) - rig.T_B_C.translation();
  return ~(sim::render(world, sim::leftCamera(rig, T_W_B)).depth_m < 1.0);
}

Verdict verdictOn(const World& world, const cv::Mat& mask) {
  Pipeline pipeline(Config(), StereoGeometry(sim::defaultRig().calibration), {{}, opticalFromForward(), {mask, ""}});
  return pipeline.process(sim::stillPair(world, 1)).verdict;
}

TEST(OwnParts, BlockTheCorridorUnlessTheyAreMasked) {
  const World world = withLegs({masonryAt(8.0)});
  EXPECT_EQ(verdictOn(world, {}).state, State::Blocked);
  const Verdict masked = verdictOn(world, maskOf(world));
  EXPECT_EQ(masked.state, State::Free) << describeReasons(masked.reasons);
}

TEST(OwnParts, HideNoObstacleBesideThem) {
  const World world = withLegs({masonryAt(8.0), cubeAt({3.0, 0.0, sim::kHeight_m}, 0.3)});
  const Verdict verdict = verdictOn(world, maskOf(world));
  EXPECT_EQ(verdict.state, State::Blocked);
  EXPECT_NEAR(verdict.clear_distance_m, 2.85, 0.1);
}

/// Whether an obstacle is behind the mask or nothing: nobody can see.
TEST(OwnParts, LeaveWhatTheyHideUnobserved) {
  const sim::Primitive cube = cubeAt({3.0, 0.0, sim::kHeight_m}, 0.1);
  for (const World& world : {World{masonryAt(8.0)}, World{masonryAt(8.0), cube}}) {
    cv::Mat mask(480, 640, CV_8UC1, cv::Scalar(255));
    mask(cv::Rect(290, 210, 60, 60)) = 0;
    const Verdict verdict = verdictOn(world, mask);
    EXPECT_EQ(verdict.state, State::Unknown) << describeReasons(verdict.reasons);
    EXPECT_TRUE(verdict.reasons & kUnobserved);
  }
}

TEST(OwnParts, InACornerOfTheViewLeaveItFree) {
  cv::Mat mask(480, 640, CV_8UC1, cv::Scalar(255));
  mask(cv::Rect(0, 0, 640, 80)) = 0;  // propellers above
  mask(cv::Rect(0, 0, 30, 480)) = 0;  // a guard ring at the sides
  mask(cv::Rect(610, 0, 30, 480)) = 0;
  const Verdict verdict = verdictOn({masonryAt(8.0)}, mask);
  EXPECT_EQ(verdict.state, State::Free) << describeReasons(verdict.reasons);
}

TEST(OwnParts, HaveNeitherMatchesNorPointsNorDoubt) {
  const World world = withLegs({masonryAt(8.0)});
  const cv::Mat mask = maskOf(world);
  Pipeline pipeline(Config(), StereoGeometry(sim::defaultRig().calibration), {{}, opticalFromForward(), {mask, ""}});
  pipeline.process(sim::stillPair(world, 1));
  const cv::Mat matched = pipeline.disparity().best_px == pipeline.disparity().best_px;
  const cv::Mat repeated = pipeline.disparity().repeated_px == pipeline.disparity().repeated_px;
  ASSERT_GT(cv::countNonZero(pipeline.covered()), 1000);
  EXPECT_EQ(cv::countNonZero((matched | repeated | pipeline.doubtful()) & pipeline.covered()), 0);
  EXPECT_EQ(cv::countNonZero(pipeline.depth() < 1.0f), 0) << "matches of the legs beside the mask";
}

}  // namespace
}  // namespace flight_corridor
