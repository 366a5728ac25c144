#include <gtest/gtest.h>

#include <cmath>

#include "sim/world.hpp"

namespace flight_corridor::sim {
namespace {

const Eigen::Vector3f kForward = Eigen::Vector3f::UnitX();

TEST(Intersect, MeetsTheNearSideWithAnOutwardNormal) {
  for (const Shape shape : {Shape::Box, Shape::Cylinder, Shape::Sphere}) {
    Primitive primitive;
    primitive.shape = shape;
    const auto hit = intersect(primitive, {-3.0f, 0.0f, 0.0f}, kForward);
    ASSERT_TRUE(hit);
    EXPECT_FLOAT_EQ(hit->t, 2.5f);
    EXPECT_TRUE(hit->normal_O.isApprox(-kForward));
  }
}

TEST(Intersect, MeetsTheEndOfACylinder) {
  Primitive cylinder;
  cylinder.shape = Shape::Cylinder;
  const auto hit = intersect(cylinder, {0.2f, 0.1f, 5.0f}, -Eigen::Vector3f::UnitZ());
  ASSERT_TRUE(hit);
  EXPECT_FLOAT_EQ(hit->t, 4.5f);
  EXPECT_TRUE(hit->normal_O.isApprox(Eigen::Vector3f::UnitZ()));
  EXPECT_FALSE(intersect(cylinder, {0.6f, 0.1f, 5.0f}, -Eigen::Vector3f::UnitZ()));
}

TEST(Intersect, MeetsNothingBehindBesideOrAroundTheOrigin) {
  for (const Shape shape : {Shape::Box, Shape::Cylinder, Shape::Sphere}) {
    Primitive primitive;
    primitive.shape = shape;
    EXPECT_FALSE(intersect(primitive, {3.0f, 0.0f, 0.0f}, kForward));
    EXPECT_FALSE(intersect(primitive, {-3.0f, 0.6f, 0.0f}, kForward));
    EXPECT_FALSE(intersect(primitive, {0.0f, 0.0f, 0.0f}, kForward));
  }
}

TEST(Intersect, DoesNotLoseAThinPoleFarAway) {
  const Primitive pole = makeCylinder({0, 0, -1}, {0, 0, 1}, 0.02, {});
  const Eigen::Vector3f origin(-80.0f, 0.0f, 0.0f);
  EXPECT_TRUE(intersect(pole, origin, Eigen::Vector3f(1.0f, 0.019f / 80.0f, 0.0f)));
  EXPECT_FALSE(intersect(pole, origin, Eigen::Vector3f(1.0f, 0.021f / 80.0f, 0.0f)));
}

TEST(MakeCylinder, StandsBetweenItsEnds) {
  const Eigen::Vector3d from(1, 2, 3), to(4, -2, 3);
  const Primitive cylinder = makeCylinder(from, to, 0.1, {});
  EXPECT_TRUE((cylinder.T_W_O * Eigen::Vector3d(0, 0, -cylinder.half_m.z())).isApprox(from));
  EXPECT_TRUE((cylinder.T_W_O * Eigen::Vector3d(0, 0, cylinder.half_m.z())).isApprox(to));
}

TEST(VisibleAt, MovesPrimitivesAndLeavesOutWhatIsNotThere) {
  Primitive moving;
  moving.velocity_W = {1.0, -0.5, 0.0};
  Primitive brief;
  brief.visible_from_s = 1.0;
  brief.visible_until_s = 2.0;
  EXPECT_EQ(visibleAt({moving, brief}, 0.5).size(), 1u);
  EXPECT_EQ(visibleAt({moving, brief}, 1.0).size(), 2u);
  EXPECT_EQ(visibleAt({moving, brief}, 2.0).size(), 1u);
  EXPECT_TRUE(visibleAt({moving}, 2.0)[0].T_W_O.translation().isApprox(Eigen::Vector3d(2.0, -1.0, 0.0)));
}

TEST(Foliage, HasItsLeavesWithinItsSphereAndGapsBetweenThem) {
  const Primitive foliage = makeFoliage({0, 0, 0}, 0.8, {});
  int leaves = 0, rays = 0;
  for (float y = -0.75f; y < 0.76f; y += 0.05f) {
    for (float z = -0.75f; z < 0.76f; z += 0.05f) {
      if (y * y + z * z > 0.4f) continue;
      ++rays;
      const Eigen::Vector3f origin(-3.0f, y, z), direction(1.0f, 0.0f, 0.0f);
      const auto leaf = intersect(foliage, origin, direction);
      if (!leaf) continue;
      ++leaves;
      EXPECT_LE((origin + leaf->t * direction).norm(), 0.8f * 1.0001f) << y << ", " << z;  // float's rounding
      EXPECT_LE(leaf->normal_O.dot(direction), 0.0f) << y << ", " << z;
      EXPECT_NEAR(leaf->normal_O.norm(), 1.0f, 1e-5f);
    }
  }
  EXPECT_GT(leaves, rays / 2);
  EXPECT_LT(leaves, rays);
}

TEST(Foliage, ALeafIsWhereItIsSeenFromEverySide) {
  const Primitive foliage = makeFoliage({0, 0, 0}, 0.8, {});
  int seen = 0;
  for (float angle = 0.0f; angle < 6.28f; angle += 0.1f) {
    const Eigen::Vector3f from(3.0f * std::cos(angle), 3.0f * std::sin(angle), 0.4f);
    const Eigen::Vector3f direction = -from.normalized();
    const auto leaf = intersect(foliage, from, direction);
    if (!leaf) continue;
    ++seen;
    // From just before it, the same leaf is met.
    const Eigen::Vector3f before = from + (leaf->t - 0.01f) * direction;
    const auto again = intersect(foliage, before, direction);
    ASSERT_TRUE(again) << angle;
    EXPECT_NEAR(again->t, 0.01f, 1e-4f) << angle;
  }
  EXPECT_GT(seen, 10);
}

}  // namespace
}  // namespace flight_corridor::sim
