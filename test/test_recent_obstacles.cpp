#include <gtest/gtest.h>

#include <vector>

#include "flight_corridor/corridor/recent_obstacles.hpp"

namespace flight_corridor {
namespace {

constexpr double kHold_s = 0.25, kSmallest_m = 0.05;
const Box kBox_C{opticalFromForward(), {4.0, 1.2, 0.4}};

CameraPose at(const Eigen::Vector3d& p_V, int series = 0) {
  CameraPose pose;
  pose.T_M_C.translation() = p_V;
  pose.series = series;
  return pose;
}

class RecentObstaclesTest : public testing::Test {
 protected:
  /// A branch 2 m ahead that shows as much, at 10 s.
  void seeABranch(double shown_m2 = 0.002, const std::optional<CameraPose>& pose = at({0, 0, 0})) {
    recent_.moveTo(10.0, pose, kHold_s);
    const auto half_m2 = static_cast<float>(shown_m2 / 2.0);
    recent_.add({{{0.0f, 0.0f, 2.0f}, half_m2}, {{0.05f, 0.0f, 2.1f}, half_m2}}, {}, true);
  }

  double freeUpTo(double stamp_s, const std::optional<CameraPose>& pose = at({0, 0, 0}), const Fan& fan_C = kBox_C) {
    recent_.moveTo(stamp_s, pose, kHold_s);
    return recent_.freeUpTo(fan_C, kSmallest_m).front();
  }

  RecentObstacles recent_;
};

TEST_F(RecentObstaclesTest, NothingRemainsOfWhatNeverBlocked) { EXPECT_EQ(freeUpTo(10.0), kInfinity); }

TEST_F(RecentObstaclesTest, AnObstacleRemainsWhereItStoodForTheHoldTime) {
  seeABranch();
  EXPECT_NEAR(freeUpTo(10.2), 2.0, 1e-5);
  EXPECT_NEAR(freeUpTo(10.2, at({0.0, 0.0, 0.5})), 1.5, 1e-5) << "the camera has come nearer";
  EXPECT_EQ(freeUpTo(10.2, at({1.0, 0.0, 0.0})), kInfinity) << "it is beside the corridor";
  EXPECT_EQ(freeUpTo(10.3), kInfinity) << "long ago";
}

TEST_F(RecentObstaclesTest, ADirectionRemembersAsTheCorridorDoes) {
  seeABranch();
  recent_.moveTo(10.1, at({0, 0, 0}), kHold_s);
  const std::vector<double> free_m = recent_.freeUpTo({kBox_C, {-0.6, 0.0, 0.1}, {0.0}}, kSmallest_m);
  EXPECT_EQ(free_m[0], kInfinity);
  EXPECT_NEAR(free_m[1], 2.0, 1e-5);
  EXPECT_NEAR(free_m[2], 2.0 * std::cos(0.1), 1e-5) << "0.2 m aside";
}

TEST_F(RecentObstaclesTest, WhatThePairItselfShowsIsNotRecent) {
  seeABranch();
  EXPECT_EQ(recent_.freeUpTo(kBox_C, kSmallest_m).front(), kInfinity);
  EXPECT_NEAR(freeUpTo(10.0), 2.0, 1e-5) << "another pair of the same stamp";
}

TEST_F(RecentObstaclesTest, LessThanWhatBlocksDoesNotRemain) {
  seeABranch(0.4 * kSmallest_m * kSmallest_m);
  EXPECT_EQ(freeUpTo(10.1), kInfinity);
  seeABranch(0.6 * kSmallest_m * kSmallest_m);
  EXPECT_NEAR(freeUpTo(10.1), 2.0, 1e-5);
  EXPECT_EQ(freeUpTo(10.1, at({0.62, 0.0, 0.0})), kInfinity) << "half of it is beside the corridor";
}

TEST_F(RecentObstaclesTest, TwoSightsOfItAreNotAddedUp) {
  for (int i = 0; i < 4; ++i) seeABranch(0.4 * kSmallest_m * kSmallest_m);
  EXPECT_EQ(freeUpTo(10.1), kInfinity);
}

TEST_F(RecentObstaclesTest, WhatNoPatchShowsRemainsWhateverItsSize) {
  recent_.moveTo(10.0, at({0, 0, 0}), kHold_s);
  recent_.add({}, {{0.0, 0.0, 3.0}}, true);  // the LiDAR's
  EXPECT_NEAR(freeUpTo(10.1), 3.0, 1e-5);
}

TEST_F(RecentObstaclesTest, WhereItIsNotKnownNothingIsFree) {
  seeABranch();
  EXPECT_EQ(freeUpTo(10.1, std::nullopt), 0.0);
  EXPECT_NEAR(freeUpTo(10.2), 2.0, 1e-5) << "the motion is known again";
  EXPECT_EQ(freeUpTo(10.2, at({0, 0, 0}, 1)), 0.0) << "of another series";
  CameraPose vague = at({0, 0, 0});
  vague.translation.own = 0.01;
  EXPECT_EQ(freeUpTo(10.2, vague), 0.0) << "too uncertain";
  EXPECT_EQ(freeUpTo(10.3), kInfinity);
  seeABranch(0.002, std::nullopt);
  EXPECT_EQ(freeUpTo(10.1), 0.0);
}

TEST_F(RecentObstaclesTest, WithoutAPlaceOnlyWhatBlockedTheCorridorRemains) {
  recent_.moveTo(10.0, std::nullopt, kHold_s);
  recent_.add({{{0.0f, 0.0f, 2.0f}, 1.0f}}, {}, false);
  EXPECT_EQ(freeUpTo(10.1, std::nullopt), kInfinity);
}

TEST_F(RecentObstaclesTest, ForAnotherRigAllMayRemain) {
  recent_.moveTo(10.0, at({0, 0, 0}), kHold_s);
  recent_.onBlocked();  // by a large patch
  EXPECT_EQ(freeUpTo(10.1), kInfinity);
  RecentObstacles after;
  after.takeOver(recent_);
  RecentObstacles last;
  last.takeOver(after);
  for (RecentObstacles* recent : {&after, &last}) {
    recent->moveTo(10.2, at({0, 0, 0}), kHold_s);
    EXPECT_EQ(recent->freeUpTo(kBox_C, kSmallest_m).front(), 0.0) << "two changes of rig, one after the other";
  }
}

}  // namespace
}  // namespace flight_corridor
