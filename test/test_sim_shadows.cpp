#include <gtest/gtest.h>

#include "sim/shadows.hpp"

namespace flight_corridor::sim {
namespace {

const Eigen::AlignedBox3d kRegion_W(Eigen::Vector3d(-5, -5, 0), Eigen::Vector3d(5, 5, 4));

TEST(Shadows, OfASphereIsADiscWhereTheSunsRaysEnd) {
  const Eigen::Vector3d to_sun_W = Eigen::Vector3d(1, 0, 1).normalized();
  const Shadows shadows({makeSphere({0, 0, 2.0}, 0.5, {})}, to_sun_W, kRegion_W);
  // On the ground about x = -2: as wide as the sphere, and longer by sqrt(2).
  EXPECT_EQ(shadows.lit({-2.0f, 0.0f, 0.0f}), 0.0f);
  EXPECT_EQ(shadows.lit({-2.0f, 0.44f, 0.0f}), 0.0f);
  EXPECT_EQ(shadows.lit({-2.0f, 0.56f, 0.0f}), 1.0f);
  EXPECT_EQ(shadows.lit({-2.65f, 0.0f, 0.0f}), 0.0f);
  EXPECT_EQ(shadows.lit({-2.78f, 0.0f, 0.0f}), 1.0f);
}

TEST(Shadows, LieBehindWhatThrowsThemAndNotBeforeIt) {
  const Shadows shadows({makeSphere({0, 0, 2.0}, 0.5, {})}, Eigen::Vector3d::UnitZ(), kRegion_W);
  EXPECT_EQ(shadows.lit({0.0f, 0.0f, 3.0f}), 1.0f);
  EXPECT_EQ(shadows.lit({0.0f, 0.0f, 2.5f}), 1.0f);  // its own lit side
  EXPECT_EQ(shadows.lit({0.0f, 0.0f, 1.5f}), 0.0f);
}

TEST(Shadows, AreNotOutsideOfTheirRegion) {
  const Shadows shadows({makeBox({0, 0, 2.0}, {100, 100, 0.1}, {})}, Eigen::Vector3d::UnitZ(), kRegion_W);
  EXPECT_EQ(shadows.lit({4.9f, 0.0f, 0.0f}), 0.0f);
  EXPECT_EQ(shadows.lit({5.1f, 0.0f, 0.0f}), 1.0f);
}

}  // namespace
}  // namespace flight_corridor::sim
