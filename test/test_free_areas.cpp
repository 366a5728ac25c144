#include <gtest/gtest.h>

#include <vector>

#include "flight_corridor/corridor/free_areas.hpp"

namespace flight_corridor {
namespace {

const FreeAreasConfig kConfig{0.2, 0.1, 0.1};
constexpr double kStep_rad = 0.1;
const Eigen::Vector3d kAhead = Eigen::Vector3d::UnitX();

/// FREE where a mark says so; the lowest row first.
AreaGrid marked(const char (&marks)[16]) {
  AreaGrid grid = areaGrid(kConfig);
  for (int i = 0; i < 15; ++i) grid.areas[i].verdict.state = marks[i] == '+' ? State::Free : State::Blocked;
  return grid;
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
  EXPECT_EQ(bestArea(marked("..............."), kAhead, kStep_rad), -1);
  EXPECT_EQ(bestArea(marked("+++++++++++++++"), kAhead, kStep_rad), 7);
  EXPECT_EQ(bestArea(marked(".....++........"), kAhead, kStep_rad), 6);
  EXPECT_EQ(bestArea(marked("+++++++++++++++"), {1.0, 0.2, 0.0}, kStep_rad), 9) << "to the left";
  EXPECT_EQ(bestArea(marked("+++++++++++++++"), {-5.0, 5.0, 0.0}, kStep_rad), 9)
      << "as near to a goal behind as it can";
  EXPECT_EQ(bestArea(marked(".....+...+....."), {1.0, -0.1, 0.1}, kStep_rad), 5);
}

TEST(FreeAreas, OfTwoAsNearTheOneWithMoreBesideItIsBetter) {
  EXPECT_EQ(bestArea(marked("......+.++....."), kAhead, kStep_rad), 8);
  EXPECT_EQ(bestArea(marked(".....++.+......"), kAhead, kStep_rad), 6);
}

TEST(FreeAreas, AGoalMayBeOfAnyLength) {
  for (const double length : {1e-200, 1e200}) {
    EXPECT_EQ(bestArea(marked("+++++++++++++++"), length * Eigen::Vector3d(1.0, 0.2, 0.0), kStep_rad), 9) << length;
  }
}

TEST(FreeAreas, AGoalThatIsNoneIsAhead) {
  for (const Eigen::Vector3d& none : {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(kNaN, 0.0, 1.0)}) {
    EXPECT_EQ(bestArea(marked("+++++++++++++++"), none, kStep_rad), 7);
  }
}

}  // namespace
}  // namespace flight_corridor
