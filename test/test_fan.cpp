#include <gtest/gtest.h>

#include <random>
#include <set>

#include "flight_corridor/geometry/fan.hpp"
#include "support/random_pose.hpp"

namespace flight_corridor {
namespace {

const Box kBox{Eigen::Isometry3d::Identity(), {4.0, 1.2, 0.4}};

TEST(Fan, ABoxIsAFanOfOne) {
  const Fan fan(kBox);
  EXPECT_EQ(fan.size(), 1);
  EXPECT_TRUE(fan.box(0).T_M_F.isApprox(kBox.T_M_F));
}

TEST(Fan, TurnsLeftFirstThenUpAboutTheStart) {
  Box box = kBox;
  box.T_M_F.translation() = Eigen::Vector3d(1.0, 2.0, 3.0);
  const Fan fan(box, {-0.5, 0.0, 0.5}, {-0.2, 0.2});
  ASSERT_EQ(fan.size(), 6);
  const Box turned = fan.box(5);
  EXPECT_TRUE(turned.T_M_F.translation().isApprox(box.T_M_F.translation()));
  const Eigen::Vector3d ahead = turned.T_M_F.linear().col(0), left = turned.T_M_F.linear().col(1);
  EXPECT_GT(ahead.y(), 0.4) << "left";
  EXPECT_NEAR(ahead.z(), std::sin(0.2), 1e-12) << "up";
  EXPECT_NEAR(left.z(), 0.0, 1e-12) << "without a roll";
  EXPECT_LT(fan.box(0).T_M_F.linear()(1, 0), 0.0);
  EXPECT_LT(fan.box(0).T_M_F.linear()(2, 0), 0.0);
}

TEST(Fan, VisitsTheBoxesThatHoldAPointAndNoOther) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int held = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Fan fan({test_support::randomPose(random, 2.0), kBox.size_m}, {-0.5, -0.1, 0.0, 0.3}, {-0.2, 0.0, 0.1});
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d point_F(2.0 + 2.5 * unit(random), unit(random), 0.6 * unit(random));
      const Eigen::Vector3d point_C = fan.box().T_M_F * point_F;
      std::set<int> visited;
      fan.visit(fan.T_F_C() * point_C.cast<float>(), 0.0f, [&](int direction, const Eigen::Vector3f& point) {
        visited.insert(direction);
        EXPECT_TRUE(fan.contains(point));
        EXPECT_TRUE(point.isApprox(fan.turned(direction, fan.T_F_C() * point_C.cast<float>()), 1e-5f));
      });
      for (int direction = 0; direction < fan.size(); ++direction) {
        Box smaller = fan.box(direction), larger = smaller;
        smaller.size_m.array() -= 1e-4;
        larger.size_m.array() += 1e-4;
        if (contains(smaller, point_C) != contains(larger, point_C)) continue;  // on a face
        EXPECT_EQ(visited.count(direction) > 0, contains(smaller, point_C));
        held += contains(smaller, point_C);
      }
    }
  }
  EXPECT_GT(held, 1000);
}

}  // namespace
}  // namespace flight_corridor
