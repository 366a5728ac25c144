#include <gtest/gtest.h>
#include <tf2_eigen/tf2_eigen.h>

#include <cmath>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "ros/scans.hpp"
#include "support/autopilots.hpp"

namespace flight_corridor_ros {
namespace {

using flight_corridor::kInfinity;
using flight_corridor::kNaN;
using flight_corridor::LevelScan;
using namespace test_support;

std_msgs::Header camera() {
  std_msgs::Header header;
  header.frame_id = "left_optical";
  header.stamp = ros::Time(100.0);
  return header;
}

/// The first range is the rightmost.
LevelScan scanOf(const std::vector<double>& range_m, double step_rad = M_PI / 36.0) {
  LevelScan scan;
  scan.step_rad = step_rad;
  scan.first_yaw_rad = -0.5 * (static_cast<double>(range_m.size()) - 1.0) * step_rad;
  scan.max_range_m = 4.0;
  scan.range_m = range_m;
  return scan;
}

TEST(ToScan, IsAsRep117Wants) {
  const auto message = toScan(camera(), scanOf({2.5, kInfinity, kNaN, 0.0, 3.0}));
  EXPECT_EQ(message.header.frame_id, "left_optical_scan");
  EXPECT_EQ(message.header.stamp, ros::Time(100.0));
  EXPECT_NEAR(message.angle_min, -2.0 * M_PI / 36.0, 1e-6);
  EXPECT_NEAR(message.angle_max, 2.0 * M_PI / 36.0, 1e-6);
  EXPECT_NEAR(message.angle_increment, M_PI / 36.0, 1e-6);
  EXPECT_EQ(message.range_max, 4.0f);
  ASSERT_EQ(message.ranges.size(), 5u);
  EXPECT_EQ(message.ranges[0], 2.5f);
  EXPECT_EQ(message.ranges[1], INFINITY);
  EXPECT_TRUE(std::isnan(message.ranges[2]));
  EXPECT_EQ(message.ranges[3], message.range_min) << "what is nearer is not lost";
  EXPECT_GT(message.range_min, 0.0f);
}

TEST(ToScan, ItsFramesAreThoseThatItIsMeasuredIn) {
  const Eigen::Matrix3d R_C_H = flight_corridor::opticalFromForward().linear();
  const auto frames = scanFrames(camera(), R_C_H);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].header.frame_id, "left_optical");
  EXPECT_EQ(frames[0].child_frame_id, toScan(camera(), scanOf({1.0})).header.frame_id);
  EXPECT_EQ(frames[1].child_frame_id, toObstacleDistance(camera(), scanOf({1.0})).header.frame_id);
  EXPECT_EQ(frames[1].header.frame_id, frames[0].child_frame_id);
  EXPECT_EQ(frames[1].header.stamp, ros::Time(100.0));
  const Eigen::Isometry3d T_C_H = tf2::transformToEigen(frames[0]), T_H_D = tf2::transformToEigen(frames[1]);
  EXPECT_TRUE(T_C_H.linear().isApprox(R_C_H, 1e-9));
  EXPECT_TRUE((T_H_D.linear() * Eigen::Vector3d::UnitY()).isApprox(-Eigen::Vector3d::UnitY())) << "y is right";
  EXPECT_TRUE((T_H_D.linear() * Eigen::Vector3d::UnitZ()).isApprox(-Eigen::Vector3d::UnitZ())) << "z is down";
}

TEST(ToObstacleDistance, GoesClockwiseFromAheadAndKnowsNothingOutOfView) {
  // From right to left: 10 and 5 degrees right, ahead, 5 and 10 degrees left.
  const auto message = asMavrosSends(toObstacleDistance(camera(), scanOf({1.5, kInfinity, 2.5, kNaN, 3.5})));
  EXPECT_EQ(message.angle_offset, 0.0f);
  EXPECT_EQ(message.increment_f, 5.0f);
  EXPECT_EQ(message.max_distance, 400);
  EXPECT_EQ(message.distances[0], 250) << "ahead";
  EXPECT_EQ(message.distances[1], 401) << "free: a centimetre more than max_distance";
  EXPECT_EQ(message.distances[2], 150);
  EXPECT_EQ(message.distances[71], kNotKnown);
  EXPECT_EQ(message.distances[70], 350);
  for (int bin = 3; bin < 70; ++bin) EXPECT_EQ(message.distances[bin], kNotKnown) << bin;
}

TEST(ToObstacleDistance, EachOfPx4sBinsReadsItsOwnEntry) {
  const auto message = asMavrosSends(toObstacleDistance(camera(), scanOf({1.0})));
  for (int bin = 0; bin < 72; ++bin) EXPECT_EQ(entryOfPx4Bin(bin, message), bin);
}

TEST(ToObstacleDistance, ArduPilotTakesObstaclesAndNothingElse) {
  const auto message = asMavrosSends(toObstacleDistance(camera(), scanOf({kInfinity, 0.0, kNaN, 3.99, kInfinity})));
  const auto is_obstacle = [&](int bin) { return isObstacleForArduPilot(message.distances[bin], message); };
  EXPECT_TRUE(is_obstacle(1)) << "also what touches the camera: " << message.distances[1];
  EXPECT_TRUE(is_obstacle(71));
  EXPECT_FALSE(is_obstacle(0)) << "not known";
  EXPECT_FALSE(is_obstacle(2)) << "free";
}

TEST(ToObstacleDistance, FreeIsFartherThanTheMaximumForEveryLengthOfTheCorridor) {
  for (int length_cm = 50; length_cm <= 2000; ++length_cm) {
    LevelScan scan = scanOf({kInfinity});
    scan.max_range_m = length_cm / 100.0;
    const auto message = asMavrosSends(toObstacleDistance(camera(), scan));
    EXPECT_GT(message.distances[0], message.max_distance) << length_cm;
    EXPECT_LE(message.distances[0], message.max_distance + 2) << length_cm;
  }
}

TEST(ToObstacleDistance, OfFinerAndCoarserStepsTheNearestObstacleCountsAndAGapIsNotKnown) {
  const double fine_rad = M_PI / 180.0;
  std::vector<double> fine(15, kInfinity);  // 7 degrees to each side
  const auto distances = [&](const std::vector<double>& range_m, double step_rad) {
    return asMavrosSends(toObstacleDistance(camera(), scanOf(range_m, step_rad))).distances;
  };
  EXPECT_EQ(distances(fine, fine_rad)[0], 401);
  EXPECT_EQ(distances(fine, fine_rad)[1], 401);
  EXPECT_EQ(distances(fine, fine_rad)[2], kNotKnown) << "the view ends within it";
  fine[7] = kNaN;
  EXPECT_EQ(distances(fine, fine_rad)[0], kNotKnown);
  fine[8] = 2.0;
  fine[9] = 3.0;
  EXPECT_EQ(distances(fine, fine_rad)[0], 200);
  const auto coarse = distances({kInfinity, 2.0, kInfinity}, 4.0 * M_PI / 36.0);  // 20 degrees each
  EXPECT_EQ(coarse[0], 200);
  EXPECT_EQ(coarse[1], 200);
  EXPECT_EQ(coarse[4], 401);
  EXPECT_EQ(coarse[68], 401);
}

TEST(ToObstacleDistance, TheDefaultStepIsOneBin) {
  const auto message = asMavrosSends(toObstacleDistance(camera(), scanOf(std::vector<double>(17, kInfinity), 0.0873)));
  for (int bin = 0; bin <= 8; ++bin) {
    EXPECT_EQ(message.distances[bin], 401) << bin;
    EXPECT_EQ(message.distances[(72 - bin) % 72], 401) << bin;
  }
  EXPECT_EQ(message.distances[9], kNotKnown);
}

TEST(UnknownScan, SaysNothingToAnyAutopilot) {
  const LevelScan scan = flight_corridor::unknownScan(0.1, 4.0);
  const auto message = toScan(camera(), scan);
  ASSERT_EQ(message.ranges.size(), 15u);
  for (const float range_m : message.ranges) EXPECT_TRUE(std::isnan(range_m));
  for (const auto distance : asMavrosSends(toObstacleDistance(camera(), scan)).distances) {
    EXPECT_EQ(distance, kNotKnown);
  }
}

}  // namespace
}  // namespace flight_corridor_ros
