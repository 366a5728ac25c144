#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "serial/lightware.hpp"

namespace flight_corridor::serial {
namespace {

TEST(Lightware, EveryFormOfTheManualsIsRead) {
  for (const char* line : {"98.67", "98.67 m", "98.67m", "?LD 98.67", "ld,0:98.67", "ld,1:98.67"}) {
    const Parsed parsed = parseLightware(line);
    EXPECT_EQ(parsed.outcome, Parsed::Outcome::Valid) << line;
    EXPECT_EQ(parsed.measurement.range_m, 98.67) << line;
    EXPECT_TRUE(std::isnan(parsed.measurement.strength)) << line;
  }
}

TEST(Lightware, EveryDistanceThatTwoDecimalsHoldIsRead) {
  for (int distance_cm = 0; distance_cm < 100000; ++distance_cm) {
    const std::string decimals = std::to_string(100 + distance_cm % 100).substr(1);
    const std::string line = std::to_string(distance_cm / 100) + "." + decimals;
    ASSERT_EQ(parseLightware(line).measurement.range_m, distance_cm / 100.0) << line;
  }
}

TEST(Lightware, MinusOneInAnySpellingIsNothingThatReturned) {
  for (const char* line : {"-1", "-1.", "-1.0", "-1.00", "-1.000", "-01.00", "-1 m", "-1.0m", "?LD -1.00", "?LD -1",
                           "ld,0:-1.00", "ld,1:-1.0", "ld,0:-1"}) {
    const Parsed parsed = parseLightware(line);
    EXPECT_EQ(parsed.outcome, Parsed::Outcome::Valid) << line;
    EXPECT_EQ(parsed.measurement.range_m, std::numeric_limits<double>::infinity()) << line;
    EXPECT_TRUE(std::isnan(parsed.measurement.error_code)) << line;
  }
}

TEST(Lightware, AnyOtherNegativeNumberIsTheCodeOfAnError) {
  const std::pair<const char*, double> codes[]{{"-3", -3.0},     {"-3.00", -3.0},      {"ld,0:-2.0", -2.0},
                                               {"-0.05", -0.05}, {"-10", -10.0},       {"-1.01", -1.01},
                                               {"-0.00", 0.0},   {"-100.00 m", -100.0}};
  for (const auto& [line, code] : codes) {
    const Parsed parsed = parseLightware(line);
    EXPECT_EQ(parsed.outcome, Parsed::Outcome::Valid) << line;
    EXPECT_TRUE(std::isnan(parsed.measurement.range_m)) << line;
    EXPECT_EQ(parsed.measurement.error_code, code) << line;
  }
}

TEST(Lightware, WhatIsNotExactlyANumberIsMalformed) {
  for (const char* line :
       {"",         " ",         ".",         "-",         "m",      "1",        "12",     "1.",       "1.2",
        "1.234",    ".12",       "1234.00",   "1,23",      "1.2.3",  "--1.00",   "-.5",    "-1,0",     "-1.0.0",
        "-1e0",     "-1234",     "- 1.00",    "+1.00",     "0x1.00", "1.00e1",   "1e1.00", "inf",      "nan",
        "--.--",    "1.00 V",    "1.00 2.00", "1.00 mm",   "ld,0:",  "ld,:1.00", "ld,0",   "ld,01.00", "?LD",
        "?LD!1.00", "?LH 100.0", "?OA 1.56",  "lf,0:1.00", " 1.00",  "1 .00",    "1.0 0"}) {
    EXPECT_EQ(parseLightware(line).outcome, Parsed::Outcome::Malformed) << "\"" << line << "\"";
  }
  EXPECT_EQ(parseLightware(std::string("1.0\0", 4)).outcome, Parsed::Outcome::Malformed);
}

}  // namespace
}  // namespace flight_corridor::serial
