#include <gtest/gtest.h>

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

}  // namespace
}  // namespace flight_corridor::sim
