#include <gtest/gtest.h>
#include <tf2_eigen/tf2_eigen.h>

#include <cmath>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "ros/free_areas_messages.hpp"

namespace flight_corridor_ros {
namespace {

using flight_corridor::AreaGrid;
using flight_corridor::FreeAreasConfig;
using flight_corridor::kNoData;
using flight_corridor::SpeedConfig;
using flight_corridor::State;
using visualization_msgs::Marker;

const FreeAreasConfig kGrid{0.2, 0.1, 0.1};  // 5 columns, 3 rows
constexpr std::size_t kAhead = 7, kLeftmost = 9;

class FreeAreasMessages : public testing::Test {
 protected:
  FreeAreasMessages() : areas(areaGrid(kGrid)) {
    header.frame_id = "left_optical";
    header.stamp = ros::Time(100.0);
    box.T_M_F = flight_corridor::opticalFromForward();
    box.size_m = {4.0, 1.2, 0.4};
    flight_corridor::Verdict& free = areas.areas[kLeftmost].verdict;
    free.state = State::Free;
    free.clear_distance_m = flight_corridor::kInfinity;
    free.free_distance_m = 4.0;
    flight_corridor::Verdict& blocked = areas.areas[kAhead].verdict;
    blocked.state = State::Blocked;
    blocked.clear_distance_m = 3.0;
    blocked.reasons = flight_corridor::kOccupiedCell;
    areas.best = kLeftmost;
  }

  std_msgs::Header header;
  AreaGrid areas;
  flight_corridor::Box box;
};

TEST_F(FreeAreasMessages, EachDirectionIsSaidInTheCamerasFrame) {
  const auto message = toMessage(header, areas, box.T_M_F.linear(), std::nullopt, SpeedConfig(), 0.05);
  EXPECT_EQ(message.header.frame_id, "left_optical");
  EXPECT_EQ(message.rows, 3u);
  EXPECT_EQ(message.columns, 5u);
  ASSERT_EQ(message.direction.size(), 15u);
  Eigen::Vector3d left_C, goal_C;
  tf2::fromMsg(message.direction[kLeftmost], left_C);
  EXPECT_TRUE(left_C.isApprox(Eigen::Vector3d(-std::sin(0.2), 0.0, std::cos(0.2)))) << left_C;
  EXPECT_NEAR(message.yaw[kLeftmost], 0.2, 1e-12);
  EXPECT_EQ(message.state[kAhead], flight_corridor::FreeAreas::BLOCKED);
  EXPECT_EQ(message.clear_distance[kAhead], 3.0);
  EXPECT_EQ(message.reasons[kAhead], flight_corridor::kOccupiedCell);
  EXPECT_EQ(message.best, static_cast<int>(kLeftmost));
  tf2::fromMsg(message.goal, goal_C);
  EXPECT_TRUE(goal_C.isApprox(Eigen::Vector3d::UnitZ())) << "straight ahead without a wish";
}

TEST_F(FreeAreasMessages, TheSafeSpeedIsThatOfTheLawAtTheMessagesAge) {
  const SpeedConfig speed;
  const auto message = toMessage(header, areas, box.T_M_F.linear(), std::nullopt, speed, 0.05);
  EXPECT_EQ(message.safe_speed[kLeftmost], flight_corridor::safeSpeed(4.0, 0.05, speed));
  EXPECT_GT(message.safe_speed[kLeftmost], 1.0);
  EXPECT_EQ(message.safe_speed[0], 0.0) << "nothing is known there";
}

TEST_F(FreeAreasMessages, TheGoalIsAUnitVector) {
  Eigen::Vector3d goal_C;
  tf2::fromMsg(toMessage(header, areas, box.T_M_F.linear(), Eigen::Vector3d(3.0, 0.0, 4.0), SpeedConfig(), 0.0).goal,
               goal_C);
  EXPECT_TRUE(goal_C.isApprox(Eigen::Vector3d(0.6, 0.0, 0.8)));
}

TEST_F(FreeAreasMessages, ARefusalKnowsNothingInAnyDirection) {
  const auto message = toRefusal(header, kGrid, kNoData);
  ASSERT_EQ(message.state.size(), 15u);
  EXPECT_EQ(message.best, -1);
  for (std::size_t i = 0; i < message.state.size(); ++i) {
    EXPECT_EQ(message.state[i], flight_corridor::FreeAreas::UNKNOWN);
    EXPECT_EQ(message.safe_speed[i], 0.0);
    EXPECT_EQ(message.reasons[i], kNoData);
    EXPECT_TRUE(std::isnan(message.clear_distance[i]));
    EXPECT_TRUE(std::isnan(message.direction[i].x));
  }
  EXPECT_EQ(message.yaw, toMessage(header, areas, box.T_M_F.linear(), std::nullopt, SpeedConfig(), 0.0).yaw);
}

TEST_F(FreeAreasMessages, ATileStandsWhereItsDirectionEndsOrIsBlocked) {
  const auto markers = toMarkers(header, areas, box, kGrid.step_rad, std::nullopt, 0.5).markers;
  ASSERT_EQ(markers.size(), 3u);
  const Marker& tiles = markers[0];
  ASSERT_EQ(tiles.points.size(), 15u * 9u);  // three triangles each
  ASSERT_EQ(tiles.colors.size(), tiles.points.size());
  const auto reach = [&](std::size_t area) {
    const auto& p = tiles.points[9 * area];
    return Eigen::Vector3d(p.x, p.y, p.z).norm();
  };
  EXPECT_NEAR(reach(kLeftmost), 4.0, 1e-9);
  EXPECT_NEAR(reach(kAhead), 3.0, 1e-9);
  EXPECT_LT(tiles.colors[0].a, tiles.colors[9 * kAhead].a) << "not known: faint, and no ray leads there";
  EXPECT_EQ(tiles.colors[8].a, 0.0f);
  EXPECT_GT(tiles.colors[9 * kLeftmost].g, tiles.colors[9 * kLeftmost].r);
  EXPECT_GT(tiles.colors[9 * kAhead].r, tiles.colors[9 * kAhead].g);
}

TEST_F(FreeAreasMessages, ArrowsShowTheBestAndTheGoalWhereThereAreSuch) {
  const auto with = toMarkers(header, areas, box, kGrid.step_rad, Eigen::Vector3d(0.0, 0.0, 1.0), 0.5).markers;
  EXPECT_EQ(with[1].action, Marker::ADD);
  EXPECT_LT(with[1].points.at(1).x, 0.0) << "to the left";
  EXPECT_EQ(with[2].action, Marker::ADD);
  areas.best = -1;
  const auto without = toMarkers(header, areas, box, kGrid.step_rad, std::nullopt, 0.5).markers;
  EXPECT_EQ(without[1].action, Marker::DELETE);
  EXPECT_EQ(without[2].action, Marker::DELETE);
}

TEST_F(FreeAreasMessages, ARefusalTakesEveryMarkerFromTheScreen) {
  const auto shown = toMarkers(header, areas, box, kGrid.step_rad, std::nullopt, 0.5).markers;
  const auto removed = withoutMarkers(header).markers;
  ASSERT_EQ(removed.size(), shown.size());
  for (std::size_t i = 0; i < removed.size(); ++i) {
    EXPECT_EQ(removed[i].action, Marker::DELETE);
    EXPECT_EQ(removed[i].ns, shown[i].ns);
    EXPECT_EQ(removed[i].id, shown[i].id);
  }
}

}  // namespace
}  // namespace flight_corridor_ros
