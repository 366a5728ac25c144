#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "sim/random.hpp"
#include "sim/truth.hpp"

namespace flight_corridor::sim {
namespace {

const Eigen::Vector3d kCorridor_m(4.0, 1.2, 0.4);

/// Slow, obvious oracle: rays along x of F on a grid over the box's cross-section; the nearest hit within the box.
double sampledClearDistance(const Primitive& primitive, const Eigen::Isometry3d& T_W_F, double step_m) {
  const Eigen::Isometry3d T_O_F = primitive.T_W_O.inverse() * T_W_F;
  const Eigen::Vector3f direction_O = (T_O_F.linear() * Eigen::Vector3d::UnitX()).cast<float>();
  double clear_m = kInfinity;
  for (double y = -kCorridor_m.y() / 2; y <= kCorridor_m.y() / 2 + 1e-9; y += step_m) {
    for (double z = -kCorridor_m.z() / 2; z <= kCorridor_m.z() / 2 + 1e-9; z += step_m) {
      const auto hit = intersect(primitive, (T_O_F * Eigen::Vector3d(0, y, z)).cast<float>(), direction_O);
      if (hit && hit->t <= kCorridor_m.x()) clear_m = std::min<double>(clear_m, hit->t);
    }
  }
  return clear_m;
}

/// Somewhere about the corridor, turned anyhow, nowhere behind its start.
Primitive randomPrimitive(Random& random) {
  Primitive primitive;
  primitive.shape = static_cast<Shape>(random.word() % 3);
  const double radius_m = random.uniform(0.02, 0.4);
  primitive.half_m = {radius_m, radius_m, primitive.shape == Shape::Sphere ? radius_m : random.uniform(0.02, 0.8)};
  primitive.T_W_O.translation() << random.uniform(1.2, 4.6), random.uniform(-1.2, 1.2), random.uniform(-0.8, 0.8);
  const Eigen::Vector3d axis(random.normal(1.0), random.normal(1.0), random.normal(1.0));
  primitive.T_W_O.rotate(Eigen::AngleAxisd(random.uniform(0.0, 3.0), axis.normalized()));
  return primitive;
}

Primitive grown(Primitive primitive, double by_m) {
  primitive.half_m.array() += by_m;
  return primitive;
}

TEST(ClearDistance, LiesBetweenSampledDistancesToThePrimitiveAndToAGrownOne) {
  // No point of the cross-section is farther than step/sqrt(2) from a ray. So wherever a primitive touches the box, a
  // ray meets the primitive grown by that, and not later. Slack: single precision of the rays.
  constexpr double kStep_m = 0.01;
  constexpr double kSlack_m = 1e-4;
  Random random(1, Stream::Scene);
  Eigen::Isometry3d T_W_F = Eigen::Isometry3d::Identity();
  T_W_F.rotate(Eigen::AngleAxisd(0.05, Eigen::Vector3d(1, 2, 3).normalized()));
  int blocked = 0;
  for (int i = 0; i < 400; ++i) {
    const Primitive primitive = randomPrimitive(random);
    std::ostringstream input;
    input << "case " << i << " shape " << static_cast<int>(primitive.shape) << " half " << primitive.half_m.transpose()
          << "\n"
          << primitive.T_W_O.matrix();
    SCOPED_TRACE(input.str());
    const double clear_m = clearDistance({primitive}, T_W_F, kCorridor_m);
    EXPECT_LE(clear_m, sampledClearDistance(primitive, T_W_F, kStep_m) + kSlack_m);
    EXPECT_GE(clear_m, sampledClearDistance(grown(primitive, kStep_m * std::sqrt(0.5)), T_W_F, kStep_m) - kSlack_m);
    blocked += clear_m < kInfinity;
  }
  EXPECT_GT(blocked, 100);
  EXPECT_LT(blocked, 350);
}

TEST(ClearDistance, IsExactForAWallAcross) {
  const Primitive wall = makeBox({3.5, 0, 0}, {1, 20, 5}, {});
  EXPECT_NEAR(clearDistance({wall}, Eigen::Isometry3d::Identity(), kCorridor_m), 3.0, 5e-6);
}

TEST(ClearDistance, IsExactForAPoleThatLeansInFromTheSide) {
  const Primitive pole = makeCylinder({3, 0.62, -2}, {3, 0.62, 2}, 0.03, {});
  const double expected_m = 3.0 - std::sqrt(0.03 * 0.03 - 0.02 * 0.02);
  // Touching is decided to 1e-6 m across; along the axis that is 1e-6 * slope (0.9) and the bisection's 1e-6.
  EXPECT_NEAR(clearDistance({pole}, Eigen::Isometry3d::Identity(), kCorridor_m), expected_m, 1e-5);
}

TEST(ClearDistance, IsInfiniteForWhatStandsBesideAboveOrBeyond) {
  const std::vector<Primitive> world{makeCylinder({3, 0.64, -2}, {3, 0.64, 2}, 0.03, {}),
                                     makeBox({2, 0, 0.71}, {1, 1, 1}, {}), makeSphere({4.31, 0, 0}, 0.3, {}),
                                     makeBox({0, 0, -2}, {300, 300, 1}, {})};
  EXPECT_EQ(clearDistance(world, Eigen::Isometry3d::Identity(), kCorridor_m), kInfinity);
}

TEST(ClearDistance, IsZeroInsideAPrimitive) {
  EXPECT_NEAR(clearDistance({makeSphere({0, 0, 0}, 0.5, {})}, Eigen::Isometry3d::Identity(), kCorridor_m), 0.0, 1e-5);
}

TEST(ClearDistance, IsTheNearestOfAll) {
  const Primitive near = makeSphere({2.3, 0, 0}, 0.3, {}), far = makeBox({3.5, 0, 0}, {1, 1, 1}, {});
  EXPECT_NEAR(clearDistance({far, near}, Eigen::Isometry3d::Identity(), kCorridor_m), 2.0, 1e-5);
  EXPECT_NEAR(clearDistance({near, far}, Eigen::Isometry3d::Identity(), kCorridor_m), 2.0, 1e-5);
}

TEST(CorridorTruth, LooksAlongTheOpticalAxisOfTheLeftCamera) {
  Eigen::Isometry3d T_W_C = Eigen::Isometry3d::Identity();  // z of C along z of W
  const CorridorTruth truth = corridorTruth({makeBox({0, 0, 2.5}, {0.1, 0.1, 1.0}, {})}, T_W_C, kCorridor_m);
  EXPECT_NEAR(truth.clear_exact_m, 2.0, 1e-5);
}

TEST(CorridorTruth, TheBoxIsWideAlongXAndLowAlongYOfTheCamera) {
  const auto clearOf = [](const Eigen::Vector3d& centre_C) {
    return corridorTruth({makeSphere(centre_C, 0.01, {})}, Eigen::Isometry3d::Identity(), kCorridor_m);
  };
  EXPECT_LT(clearOf({0.48, 0, 2}).clear_shrunk_m, 4.0);
  EXPECT_EQ(clearOf({0.55, 0, 2}).clear_shrunk_m, kInfinity);
  EXPECT_LT(clearOf({0.55, 0, 2}).clear_exact_m, 4.0);
  EXPECT_LT(clearOf({-0.68, 0, 2}).clear_inflated_m, 4.0);
  EXPECT_EQ(clearOf({-0.68, 0, 2}).clear_exact_m, kInfinity);
  EXPECT_EQ(clearOf({0, 0.25, 2}).clear_exact_m, kInfinity);
  EXPECT_LT(clearOf({0, 0.25, 2}).clear_inflated_m, 4.0);
  EXPECT_LT(clearOf({0, 0, 4.05}).clear_inflated_m, 4.1);
  EXPECT_EQ(clearOf({0, 0, 4.05}).clear_exact_m, kInfinity);
  EXPECT_EQ(clearOf({0, 0, 3.95}).clear_shrunk_m, kInfinity);
}

}  // namespace
}  // namespace flight_corridor::sim
