#include <gtest/gtest.h>

#include "serial/protocol.hpp"

namespace flight_corridor::serial {
namespace {

TEST(Protocol, EveryNameIsReadAsItIsWritten) {
  for (const Protocol protocol : kProtocols) EXPECT_EQ(parseProtocol(toString(protocol)), protocol);
  for (const char* name : {"", "TFmini", "tfmini ", "sonar"}) EXPECT_FALSE(parseProtocol(name)) << name;
}

TEST(Protocol, DefaultsAreASensors) {
  for (const Protocol protocol : kProtocols) {
    const SensorDefaults defaults = defaultsOf(protocol);
    EXPECT_GT(defaults.field_of_view_rad, 0.0);
    EXPECT_GT(defaults.min_range_m, 0.0);
    EXPECT_GT(defaults.max_range_m, 4.0) << "the corridor's length";
    EXPECT_TRUE(hasStrength(protocol) || defaults.strength_min == 0.0);
  }
}

}  // namespace
}  // namespace flight_corridor::serial
