#include <gtest/gtest.h>

#include <vector>

#include "flight_corridor/corridor/free_areas.hpp"

namespace flight_corridor {
namespace {

const FreeAreasConfig kConfig{0.2, 0.1, 0.1};
constexpr double kStep_rad = 0.1;
const Eigen::Vector3d kAhead = Eigen::Vector3d::UnitX();

constexpr double kWidth_m = 1.2;

/// FREE where a mark says so, UNKNOWN but free for so many metres where there is a digit; the lowest row first.
AreaGrid marked(const char (&marks)[16]) {
  AreaGrid grid = areaGrid(kConfig);
  for (int i = 0; i < 15; ++i) {
    Verdict& verdict = grid.areas[i].verdict;
    verdict.state = marks[i] == '+' ? State::Free : marks[i] == '.' ? State::Blocked : State::Unknown;
    verdict.free_distance_m = marks[i] == '+' ? 4.0 : marks[i] == '.' ? 0.0 : marks[i] - '0';
  }
  return grid;
}

int wayOf(const char (&marks)[16], const Eigen::Vector3d& goal_F = kAhead) {
  AreaGrid grid = marked(marks);
  grid.best = bestArea(grid, goal_F, kStep_rad);
  const int way = bestWay(grid, goal_F, kWidth_m, SpeedConfig());
  EXPECT_TRUE(grid.best < 0 || grid.areas[grid.best].verdict.state == State::Free);
  return way;
}

TEST(FreeAreas, TheGridIsSymmetricAndHasTheAxis) {
  const FreeAreasConfig config;
  EXPECT_EQ(gridAngles(config.yaw_rad, config.step_rad).size(), 13u);
  EXPECT_EQ(gridAngles(config.pitch_rad, config.step_rad).size(), 5u);
  EXPECT_EQ(gridAngles(0.0, 0.1), std::vector<double>{0.0});
  EXPECT_EQ(gridAngles(0.25, 0.1).size(), 5u) << "whole steps only";
}

TEST(FreeAreas, ADirectionLooksToItsYawAndPitch) {
  EXPECT_TRUE(ahead(FreeArea{0.0, 0.0, {}}).isApprox(kAhead));
  EXPECT_GT(ahead(FreeArea{0.2, 0.0, {}}).y(), 0.1) << "left";
  EXPECT_GT(ahead(FreeArea{0.0, 0.2, {}}).z(), 0.1) << "up";
}

TEST(FreeAreas, TheBestIsTheFreeOneNearestToTheGoal) {
  EXPECT_EQ(wayOf("..............."), -1);
  EXPECT_EQ(wayOf("+++++++++++++++"), 7);
  EXPECT_EQ(wayOf(".....++........"), 6);
  EXPECT_EQ(wayOf("+++++++++++++++", {1.0, 0.2, 0.0}), 9) << "to the left";
  EXPECT_EQ(wayOf("+++++++++++++++", {-5.0, 5.0, 0.0}), 9)
      << "as near to a goal behind as it can";
  EXPECT_EQ(wayOf(".....+...+.....", {1.0, -0.1, 0.1}), 5);
}

TEST(FreeAreas, OfTwoAsNearTheOneWithMoreBesideItIsBetter) {
  EXPECT_EQ(wayOf("......+.++....."), 8);
  EXPECT_EQ(wayOf(".....++.+......"), 6);
}

TEST(FreeAreas, AShorterWayIsBetterOnlyWhereItGetsNearerToTheGoalFaster) {
  EXPECT_EQ(wayOf(".......3......."), 7) << "nothing is FREE";
  EXPECT_EQ(bestArea(marked(".......3......."), kAhead, kStep_rad), -1);
  EXPECT_EQ(wayOf(".......3..+....", {0.0, 1.0, 0.0}), 10);
  EXPECT_EQ(wayOf("......43..+...."), 10) << "a FREE one as near to the goal is faster";
  EXPECT_EQ(wayOf(".......4..+....", {1.0, 9.0, 0.0}), 7) << "that leads away";
  EXPECT_EQ(wayOf("......44......."), 7) << "nearer to the goal";
}

TEST(FreeAreas, NoWayIsUsableThatEndsBeforeTheUavCanTurn) {
  EXPECT_EQ(wayOf(".......1......."), -1);
  Verdict verdict;
  verdict.free_distance_m = 3.0;
  EXPECT_DOUBLE_EQ(usableDistance(verdict, kWidth_m), 1.8);
  verdict.state = State::Free;
  EXPECT_DOUBLE_EQ(usableDistance(verdict, kWidth_m), 3.0);
  verdict.state = State::Unknown;
  verdict.free_distance_m = 1.0;
  EXPECT_EQ(usableDistance(verdict, kWidth_m), 0.0);
}

TEST(FreeAreas, AWayThatLeadsAwayIsTakenOnlyIfItIsFree) {
  EXPECT_EQ(wayOf(".......+.......", -kAhead), 7);
  EXPECT_EQ(wayOf(".......3.......", -kAhead), -1);
}

TEST(FreeAreas, AGoalMayBeOfAnyLength) {
  for (const double length : {1e-200, 1e200}) {
    EXPECT_EQ(wayOf("+++++++++++++++", length * Eigen::Vector3d(1.0, 0.2, 0.0)), 9) << length;
  }
}

TEST(FreeAreas, AGoalThatIsNoneIsAhead) {
  for (const Eigen::Vector3d& none : {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(kNaN, 0.0, 1.0)}) {
    EXPECT_EQ(wayOf("+++++++++++++++", none), 7);
  }
}

TEST(FreeAreas, BrokenRulesAreNamed) {
  FreeAreasConfig config;
  EXPECT_EQ(check(config), Violations());
  config = {2.0, -0.1, 0.001};
  EXPECT_EQ(check(config).size(), 3u);
}

}  // namespace
}  // namespace flight_corridor
