#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "flight_corridor/geometry/box.hpp"
#include "sim/truth.hpp"
#include "support/random_octree.hpp"
#include "support/random_pose.hpp"

namespace flight_corridor {
namespace {

using test_support::randomPose;

using test_support::kResolution_m;

TEST(Box, ImpossibleOnesAreNamed) {
  const Box good{Eigen::Isometry3d::Identity(), {4.0, 1.2, 0.4}};
  EXPECT_EQ(check(good, kResolution_m), Violations());
  const auto names = [&](const Box& box, const std::string& key) {
    const Violations broken = check(box, kResolution_m);
    return std::any_of(broken.begin(), broken.end(), [&](const std::string& rule) { return rule.find(key) == 0; });
  };
  for (const double size_m : {0.0, -1.0, 100.1, kNaN, kInfinity}) {
    Box box = good;
    box.size_m.y() = size_m;
    EXPECT_TRUE(names(box, "box/width_m")) << size_m;
  }
  Box box = good;
  box.T_M_F.translation().z() = kNaN;
  EXPECT_TRUE(names(box, "box/position"));
  box = good;
  box.T_M_F.linear() *= 2.0;
  EXPECT_TRUE(names(box, "box/orientation"));
  box.T_M_F.linear().setConstant(kNaN);
  EXPECT_TRUE(names(box, "box/orientation"));
  box = good;
  box.size_m.setConstant(41.0);  // 6 faces of 410 x 410 cells
  EXPECT_TRUE(names(box, "box/surface"));
}

TEST(Box, ContainsItsFacesButNotItsEnd) {
  const Box box{Eigen::Isometry3d(Eigen::Translation3d(1.0, 2.0, 3.0)), {4.0, 1.2, 0.4}};
  EXPECT_TRUE(contains(box, {1.0, 2.0, 3.0}));
  EXPECT_TRUE(contains(box, {4.9, 2.59, 3.19}));
  EXPECT_TRUE(contains(box, {4.9, 1.41, 2.81}));
  EXPECT_FALSE(contains(box, {0.9, 2.0, 3.0}));
  EXPECT_FALSE(contains(box, {5.0, 2.0, 3.0}));
  EXPECT_FALSE(contains(box, {3.0, 2.61, 3.0}));
  EXPECT_FALSE(contains(box, {3.0, 2.0, 2.79}));
  EXPECT_FALSE(contains(box, {kNaN, 2.0, 3.0}));
}

TEST(Box, ItAndACubeMeetExactlyWhenASharedPointExists) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int met = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Box box;
    box.T_M_F = randomPose(random, 0.5);
    box.size_m = {1.0, 0.6, 0.3};
    const Eigen::Vector3d centre(unit(random), unit(random), unit(random));
    const auto cube = [&](double edge) {
      return sim::makeBox(centre, Eigen::Vector3d::Constant(edge), sim::Material());
    };
    // The simulation's test is another algorithm, exact to 1e-6 m: between a slightly smaller and larger cube both
    // agree.
    const bool surely = sim::overlaps(box.T_M_F, box.size_m, cube(0.4 - 1e-4));
    const bool possibly = sim::overlaps(box.T_M_F, box.size_m, cube(0.4 + 1e-4));
    const bool answer = intersects(box, centre, 0.4);
    EXPECT_TRUE(answer || !surely) << "trial " << trial;
    EXPECT_TRUE(!answer || possibly) << "trial " << trial;
    met += answer;
  }
  EXPECT_GT(met, 100);
  EXPECT_LT(met, 1900);
}

TEST(Box, NoPointInItIsFartherThanItsFarthestCorner) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  for (int trial = 0; trial < 100; ++trial) {
    const Box box{randomPose(random, 3.0), {4.0, 1.2, 0.4}};
    double farthest_m = -kInfinity;
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d share(0.5 + unit(random), unit(random), unit(random));
      farthest_m = std::max(farthest_m, (box.T_M_F * box.size_m.cwiseProduct(share)).z());
    }
    EXPECT_LE(farthest_m, farthestCorner(box));
    EXPECT_GT(farthest_m, farthestCorner(box) - 1.5) << "and not far behind all of it";
  }
}

}  // namespace
}  // namespace flight_corridor
