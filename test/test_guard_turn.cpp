#include <gtest/gtest.h>

#include <cmath>

#include "ros/guard_turn.hpp"

namespace flight_corridor_ros {
namespace {

Eigen::Quaterniond attitude(double heading_rad, double roll_rad = 0.0) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ()) *
                            Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX()));
}

TEST(HeadingHistory, ATurnIsMeasuredBetweenTheAttitudesAroundTheStampAndTheNewest) {
  HeadingHistory history;
  for (int i = 0; i <= 10; ++i) history.add(ros::Time(10.0 + 0.05 * i), attitude(0.05 * i));
  for (const double stamp_s : {10.0, 10.1, 10.123, 10.5}) {
    const auto turn = history.since(ros::Time(stamp_s));
    ASSERT_TRUE(turn) << stamp_s;
    EXPECT_NEAR(turn->rad, 10.5 - stamp_s, 1e-6) << stamp_s;
    EXPECT_NEAR(turn->until_s, 10.5, 1e-6);
  }
}

TEST(HeadingHistory, WhereNoAttitudesEncloseTheStampNothingIsMeasured) {
  HeadingHistory history;
  EXPECT_FALSE(history.since(ros::Time(10.0)));
  history.add(ros::Time(10.0), attitude(0.0));
  history.add(ros::Time(10.3), attitude(0.1));
  for (const double stamp_s : {9.99, 10.1, 10.31}) EXPECT_FALSE(history.since(ros::Time(stamp_s))) << stamp_s;
}

TEST(HeadingHistory, AMountingRollAndAFullTurnDoNotMatter) {
  const Eigen::Quaterniond R_B_I(Eigen::AngleAxisd(2.0, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
  HeadingHistory history;
  for (int i = 0; i <= 100; ++i) history.add(ros::Time(10.0 + 0.05 * i), attitude(-0.1 * i, 0.3) * R_B_I);
  EXPECT_NEAR(history.since(ros::Time(10.0))->rad, -10.0, 1e-6);
  history.add(ros::Time(15.05), attitude(-10.0, -0.3) * R_B_I);  // from one bank to the other
  EXPECT_NEAR(history.since(ros::Time(15.0))->rad, 0.0, 1e-6);
}

TEST(HeadingHistory, ATimeThatWasSetBackBeginsAnew) {
  HeadingHistory history;
  history.add(ros::Time(100.0), attitude(1.0));
  history.add(ros::Time(99.9), attitude(2.0));  // out of order: left out
  EXPECT_EQ(history.since(ros::Time(100.0))->rad, 0.0);
  history.add(ros::Time(10.0), attitude(0.0));
  history.add(ros::Time(10.05), attitude(0.5));
  EXPECT_NEAR(history.since(ros::Time(10.0))->rad, 0.5, 1e-9);
}

TEST(CommandedTurns, TheCommandInForceAtThatTimeIsTheFirstThatCounts) {
  CommandedTurns turns;
  EXPECT_EQ(turns.ratesSince(0.0).left_rad_s, 0.0);
  turns.add(ros::Time(10.0), 2.0);
  turns.add(ros::Time(11.0), -1.0);
  turns.add(ros::Time(12.0), 0.5);
  EXPECT_EQ(turns.ratesSince(10.5).left_rad_s, 2.0);
  EXPECT_EQ(turns.ratesSince(11.5).left_rad_s, 0.5);
  EXPECT_EQ(turns.ratesSince(11.5).right_rad_s, -1.0);
  EXPECT_EQ(turns.ratesSince(12.5).right_rad_s, 0.0);
}

TEST(GuardTurn, WhatIsNotMeasuredIsAsCommandedAtWorstToBothSides) {
  GuardTurn turn(0.2);
  turn.commanded.add(ros::Time(9.0), 1.0);
  turn.commanded.add(ros::Time(9.9), -0.5);
  TurnRange range = turn.since(ros::Time(10.0), ros::Time(10.4));  // 1 rad/s was in force 0.2 s before the stamp
  EXPECT_NEAR(range.left_rad, 0.4, 1e-6);
  EXPECT_NEAR(range.right_rad, -0.2, 1e-6);
  for (int i = 0; i <= 6; ++i) turn.by_tf.add(ros::Time(10.0 + 0.05 * i), attitude(-0.05 * i));
  for (int i = 0; i <= 2; ++i) turn.by_imu.add(ros::Time(10.0 + 0.05 * i), attitude(0.0));  // is known for less long
  range = turn.since(ros::Time(10.0), ros::Time(10.4));  // -0.3 rad in 0.3 s, and 0.1 s at -0.5 rad/s
  EXPECT_NEAR(range.left_rad, 0.0, 1e-6);
  EXPECT_NEAR(range.right_rad, -0.35, 1e-6);
}

TEST(GuardTurn, AnOrientationThatStandsStillWhileTheGyroscopesTurnIsNotBelievedAlone) {
  GuardTurn turn(0.2);
  for (int i = 0; i <= 10; ++i) {
    turn.by_imu.add(ros::Time(10.0 + 0.05 * i), attitude(0.0));
    turn.by_rate.add(ros::Time(10.0 + 0.05 * i), 1.0);
  }
  const TurnRange range = turn.since(ros::Time(10.1), ros::Time(10.5));
  EXPECT_NEAR(range.left_rad, 0.4, 1e-6);
  EXPECT_EQ(range.right_rad, 0.0);
}

TEST(GuardTurn, RatesWithAGapTellNoTurnAcrossIt) {
  GuardTurn turn(0.2);
  for (const double stamp_s : {10.0, 10.05, 10.5, 10.55}) turn.by_rate.add(ros::Time(stamp_s), 1.0);
  EXPECT_FALSE(turn.by_rate.since(ros::Time(10.02)));
  EXPECT_NEAR(turn.by_rate.since(ros::Time(10.5))->rad, 0.05, 1e-6);
}

}  // namespace
}  // namespace flight_corridor_ros
