#include <gtest/gtest.h>

#include "ros/stamp_age.hpp"
#include "support/contains.hpp"

namespace flight_corridor_ros {
namespace {

using flight_corridor::test_support::contains;

TEST(StampAge, AStampFromTheFutureIsNamedAsOne) {
  EXPECT_EQ(describeAge(0.61), "0.610 s old");
  EXPECT_EQ(describeAge(-0.61), "stamped 0.610 s ahead of the clock");
  EXPECT_EQ(describeAge(0.0), "0.000 s old");
}

TEST(StampAge, HoursAreSaidAsHours) {
  EXPECT_EQ(describeAge(-3600.25), "stamped 3600.250 s (1.0 h) ahead of the clock");
  EXPECT_EQ(describeAge(19800.0), "19800.000 s (5.5 h) old");
  EXPECT_TRUE(contains(describeAge(1.7e9), "(472222.2 h) old"));
}

TEST(StampAge, AWrongTimeZoneIsGuessed) {
  for (const double age_s : {-3600.2, 3599.0, -7200.0, 19800.0, 36000.1, 50400.0}) {
    EXPECT_TRUE(contains(clockRemedy(age_s), "local time as UTC")) << age_s;
  }
  for (const double age_s : {0.7, -2.0, 3500.0, -1000.0, 1.7e9, 54000.0}) {
    EXPECT_FALSE(contains(clockRemedy(age_s), "local time as UTC")) << age_s;
    EXPECT_TRUE(contains(clockRemedy(age_s), "synchronise the clocks")) << age_s;
  }
}

}  // namespace
}  // namespace flight_corridor_ros
