#include <gtest/gtest.h>

#include "sim/corridor_rule.hpp"

namespace flight_corridor::sim {
namespace {

constexpr double kStep_rad = 0.1, kWidth_m = 1.2;
const Eigen::Vector3d kAhead = Eigen::Vector3d::UnitX();

/// The way through a grid of 5 x 3 directions, the lowest row first: FREE for 4 m where there is a plus, UNKNOWN but
/// free for so many metres where there is a digit, else BLOCKED.
int wayOf(const char (&marks)[16], const Eigen::Vector3d& goal_F = kAhead) {
  AreaGrid grid = areaGrid({0.2, 0.1, kStep_rad});
  for (int i = 0; i < 15; ++i) {
    Verdict& verdict = grid.areas[i].verdict;
    verdict.state = marks[i] == '+' ? State::Free : marks[i] == '.' ? State::Blocked : State::Unknown;
    verdict.free_distance_m = marks[i] == '+' ? 4.0 : marks[i] == '.' ? 0.0 : marks[i] - '0';
  }
  grid.best = bestArea(grid, goal_F, kStep_rad);
  return bestWay(grid, goal_F.normalized(), kWidth_m, SpeedConfig());
}

TEST(BestWay, AShorterWayIsBetterOnlyWhereItGetsNearerToTheGoalFaster) {
  EXPECT_EQ(wayOf(".......3......."), 7) << "nothing is FREE";
  EXPECT_EQ(wayOf(".......3..+....", {0.0, 1.0, 0.0}), 10);
  EXPECT_EQ(wayOf("......43..+...."), 10) << "a FREE one as near to the goal is faster";
  EXPECT_EQ(wayOf(".......4..+....", {1.0, 9.0, 0.0}), 7) << "that leads away";
  EXPECT_EQ(wayOf("......44......."), 7) << "nearer to the goal";
}

TEST(BestWay, NoWayIsUsableThatEndsBeforeTheUavCanTurn) {
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

TEST(BestWay, AWayThatLeadsAwayIsTakenOnlyIfItIsFree) {
  EXPECT_EQ(wayOf(".......+.......", -kAhead), 7);
  EXPECT_EQ(wayOf(".......3.......", -kAhead), -1);
}

}  // namespace
}  // namespace flight_corridor::sim
