#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <limits>
#include <string>

#include "serial/lidar_lite.hpp"
#include "support/wire.hpp"

namespace flight_corridor::serial {
namespace {

std::string lineOf(const std::string& body) {
  const std::string line = test_support::lidarLiteLine(body);
  return line.substr(0, line.size() - 2);
}

TEST(LidarLite, EveryDistanceAndStrengthIsRead) {
  for (int range_cm = 0; range_cm <= 65535; range_cm += 7) {
    const int strength = range_cm % 256;
    const Parsed parsed = parseLidarLite(lineOf("R," + std::to_string(range_cm) + "," + std::to_string(strength)));
    ASSERT_EQ(parsed.outcome, Parsed::Outcome::Valid) << range_cm;
    ASSERT_DOUBLE_EQ(parsed.measurement.range_m, range_cm / 100.0);
    ASSERT_EQ(parsed.measurement.strength, strength);
  }
}

TEST(LidarLite, TheChecksumIsThatOfNmea0183) {
  EXPECT_EQ(parseLidarLite("R,123,45*63").measurement.range_m, 1.23);  // as arduino/lidar_lite's head shows
}

TEST(LidarLite, ALineWithoutDistanceIsNoReturn) {
  const Parsed parsed = parseLidarLite(lineOf("R,,12"));
  EXPECT_EQ(parsed.outcome, Parsed::Outcome::Valid);
  EXPECT_EQ(parsed.measurement.range_m, std::numeric_limits<double>::infinity());
  EXPECT_EQ(parsed.measurement.strength, 12.0);
}

TEST(LidarLite, ASensorThatDoesNotAnswerMeasuresNothing) {
  const Parsed parsed = parseLidarLite(lineOf("E"));
  EXPECT_EQ(parsed.outcome, Parsed::Outcome::Valid);
  EXPECT_TRUE(std::isnan(parsed.measurement.range_m));
}

TEST(LidarLite, NoWrongByteGoesUnnoticed) {
  const std::string line = lineOf("R,1234,120");
  for (std::size_t i = 0; i < line.size(); ++i) {
    for (int byte = 0; byte < 256; ++byte) {
      std::string wrong = line;
      wrong[i] = static_cast<char>(byte);
      if (wrong == line) continue;
      const Parsed parsed = parseLidarLite(wrong);
      const bool is_lower_case = i + 1 == line.size() && std::tolower(line[i]) == byte;  // of a checksum's digit
      EXPECT_TRUE(parsed.outcome != Parsed::Outcome::Valid || is_lower_case) << wrong;
    }
  }
}

TEST(LidarLite, AWrongChecksumIsDistinguishedFromWhatIsNoLine) {
  EXPECT_EQ(parseLidarLite("R,123,45*00").outcome, Parsed::Outcome::WrongChecksum);
  for (const char* line : {"", "*", "*00", "R,123,45", "R,123,45*6", "R,123,45*630", "R,123,45*6G", "R,123,45* 6"}) {
    EXPECT_NE(parseLidarLite(line).outcome, Parsed::Outcome::Valid) << line;
  }
  for (const char* body : {"", "R", "R,", "R,1", "R,1,", "R,1,256", "R,65536,1", "R,-1,1", "R, 1,1", "R,1,1,1", "E,",
                           "r,1,1", "R,1.5,1", "R,1,1 "}) {
    EXPECT_EQ(parseLidarLite(lineOf(body)).outcome, Parsed::Outcome::Malformed) << body;
  }
}

}  // namespace
}  // namespace flight_corridor::serial
