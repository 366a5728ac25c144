#include <gtest/gtest.h>

#include <stdexcept>

#include "flight_corridor/config.hpp"

namespace flight_corridor {
namespace {

TEST(Config, DefaultsBreakNoRule) { EXPECT_TRUE(check(Config()).empty()); }

TEST(Config, EveryBrokenRuleIsReportedAtOnceWithKeyAndValue) {
  Config config;
  config.corridor.width_m = -1.0;
  config.stereo.num_disparities_px = 40;
  config.map.resolution_m = kNaN;
  try {
    throwIfBroken(check(config));
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("corridor/width_m"), std::string::npos);
    EXPECT_NE(text.find("(-1)"), std::string::npos);
    EXPECT_NE(text.find("stereo/num_disparities_px"), std::string::npos);
    EXPECT_NE(text.find("map/resolution_m"), std::string::npos);
  }
}

TEST(Config, AMapThatEndsBeforeTheCorridorIsRefused) {
  Config config;
  config.map.max_range_m = 3.0;
  ASSERT_EQ(check(config).size(), 1u);
  EXPECT_NE(check(config).front().find("map/max_range_m"), std::string::npos);
  config.map.max_range_m = config.corridor.length_m;
  EXPECT_TRUE(check(config).empty());
  config.corridor.offset_m.x() = 0.5;
  EXPECT_EQ(check(config).size(), 1u) << "the box ends 0.5 m farther";
}

TEST(Config, ASpeedMarginThatLeavesNothingOfTheCorridorIsRefusedAndBothAreNamed) {
  Config config;
  config.speed.margin_m = config.corridor.length_m;
  ASSERT_EQ(check(config).size(), 1u);
  EXPECT_NE(check(config).front().find("speed/margin_m: below corridor/length_m"), std::string::npos);
  EXPECT_NE(check(config).front().find("(4)"), std::string::npos);
  config.speed.margin_m = config.corridor.length_m - 0.1;
  EXPECT_TRUE(check(config).empty());
  config.corridor.length_m = 0.5;  // blind_m is 0.4
  EXPECT_EQ(check(config).size(), 1u);
}

TEST(Config, AGridOfTooManyDirectionsIsRefused) {
  Config config;
  config.free_areas = {0.5, 0.5, 0.02};
  ASSERT_EQ(check(config).size(), 1u);
  EXPECT_EQ(check(config).front(), "free_areas/step_rad: so large that there are no more than 400 directions (0.02)");
}

}  // namespace
}  // namespace flight_corridor
