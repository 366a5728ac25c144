#include <gtest/gtest.h>

#include <cmath>

#include "flight_corridor/map/hit_rule.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

const StereoCalibration kCalibration = test_support::vgaCalibration();
const HitRule kRule(MapConfig(), kCalibration);

/// Edge of a cell in the image.
double cellPixels(float depth_m) { return kCalibration.fx_px * MapConfig().resolution_m / depth_m; }

std::uint32_t firstAtLeast(double points) { return static_cast<std::uint32_t>(std::ceil(points)); }

TEST(HitRule, AShareOfAFullFaceIsAHit) {
  for (const float depth_m : {0.6f, 1.3f, 4.0f}) {
    const std::uint32_t enough = firstAtLeast(MapConfig().hit_fraction * std::pow(cellPixels(depth_m), 2));
    EXPECT_TRUE(kRule.isHit(enough, depth_m)) << depth_m;
    EXPECT_FALSE(kRule.isHit(enough - 1, depth_m)) << depth_m;
  }
}

TEST(HitRule, AFullFaceIsAsLargeAsItsCell) {
  EXPECT_NEAR(kRule.face(400, 1.0f), 400.0 / std::pow(cellPixels(1.0f), 2), 1e-6);
  EXPECT_NEAR(kRule.face(firstAtLeast(std::pow(cellPixels(2.5f), 2)), 2.5f), 1.0, 0.01);
}

TEST(HitRule, AFewPointsFarAwayAreNone) {
  const auto few = static_cast<std::uint32_t>(MapConfig().min_hit_points) - 1;
  EXPECT_FALSE(kRule.isHit(few, 100.0f));
  EXPECT_TRUE(kRule.isHit(few + 1, 100.0f));
}

TEST(HitRule, BehindTheCameraNothingIsHit) {
  EXPECT_FALSE(kRule.isHit(10000, -1.0f));
  EXPECT_FALSE(kRule.isHit(10000, 0.0f));
}

}  // namespace
}  // namespace flight_corridor
