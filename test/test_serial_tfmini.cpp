#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "serial/tfmini.hpp"
#include "support/wire.hpp"

namespace flight_corridor::serial {
namespace {

using test_support::tfminiFrame;

std::vector<TfminiReader::Reading> readingsOf(TfminiReader& reader, const std::string& stream) {
  std::vector<TfminiReader::Reading> readings;
  double arrival_s = 0.0;
  for (const char byte : stream) {
    if (const auto reading = reader.add(static_cast<std::uint8_t>(byte), arrival_s += 1.0))
      readings.push_back(*reading);
  }
  return readings;
}

Measurement measurementOf(unsigned distance, unsigned strength, double unit_m = 0.01) {
  TfminiReader::Frame frame{};
  const std::string bytes = tfminiFrame(distance, strength);
  std::copy(bytes.begin(), bytes.end(), frame.begin());
  return parseTfmini(frame, unit_m);
}

TEST(Tfmini, ADistanceIsInCentimetres) {
  const Measurement measurement = measurementOf(1234, 567);
  EXPECT_DOUBLE_EQ(measurement.range_m, 12.34);
  EXPECT_EQ(measurement.strength, 567.0);
}

TEST(Tfmini, SetToMillimetresADistanceIsAThousandthOfAMetre) {
  EXPECT_DOUBLE_EQ(measurementOf(1234, 567, 0.001).range_m, 1.234);
  TfminiReader reader(0.001);
  EXPECT_DOUBLE_EQ(readingsOf(reader, tfminiFrame(100, 500) + tfminiFrame(11999, 500)).at(0).measurement.range_m,
                   11.999);
}

TEST(Tfmini, CodesOfErrorsAreNamed) {
  const auto isNamed = [](const Measurement& measurement, double code, const char* meaning) {
    return measurement.error_code == code && std::string(measurement.error).find(meaning) != std::string::npos;
  };
  EXPECT_TRUE(isNamed(measurementOf(0xffff, 50), -1.0, "too weak"));
  EXPECT_TRUE(isNamed(measurementOf(0xfffe, 50), -2.0, "saturated"));
  EXPECT_TRUE(isNamed(measurementOf(0xfffc, 50, 0.001), -4.0, "ambient light"));
  EXPECT_TRUE(std::isnan(measurementOf(300, 0xffff).error_code));
}

TEST(Tfmini, CodesOfErrorsAreNoDistances) {
  for (const unsigned code : {0xffffu, 0xfffeu, 0xfffcu}) EXPECT_TRUE(std::isnan(measurementOf(code, 500).range_m));
  EXPECT_TRUE(std::isnan(measurementOf(300, 0xffff).range_m)) << "overexposed";
}

TEST(Tfmini, AFrameCountsWhenItFollowsAnother) {
  TfminiReader reader(0.01);
  const auto readings = readingsOf(reader, tfminiFrame(100, 500) + tfminiFrame(200, 500) + tfminiFrame(300, 500));
  ASSERT_EQ(readings.size(), 2u);
  EXPECT_DOUBLE_EQ(readings[0].measurement.range_m, 2.0);
  EXPECT_EQ(readings[0].stamp_s, 10.0) << "of its first byte";
  EXPECT_DOUBLE_EQ(readings[1].measurement.range_m, 3.0);
  EXPECT_EQ(reader.refused(), 9u);
}

TEST(Tfmini, AStreamThatIsEnteredAnywhereIsReadFromTheSecondWholeFrameOn) {
  std::string stream;
  for (unsigned i = 0; i < 6; ++i) stream += tfminiFrame(100 + i, 500 + i);
  for (std::size_t from = 0; from < 9; ++from) {
    TfminiReader reader(0.01);
    const auto readings = readingsOf(reader, stream.substr(from));
    ASSERT_EQ(readings.size(), from == 0 ? 5u : 4u) << from;
    for (std::size_t i = 0; i < readings.size(); ++i) {
      EXPECT_DOUBLE_EQ(readings[i].measurement.range_m, 1.0 + 0.01 * static_cast<double>(6 - readings.size() + i));
    }
  }
}

TEST(Tfmini, AWrongByteCostsItsFrameAndTheNext) {
  for (std::size_t wrong = 0; wrong < 9; ++wrong) {
    TfminiReader reader(0.01);
    std::string stream;
    for (unsigned i = 0; i < 6; ++i) stream += tfminiFrame(100 + i, 500);
    stream[18 + wrong] = static_cast<char>(stream[18 + wrong] ^ 0x10);
    std::vector<int> distances_cm;
    for (const auto& reading : readingsOf(reader, stream)) {
      distances_cm.push_back(static_cast<int>(std::lround(100 * reading.measurement.range_m)));
    }
    EXPECT_EQ(distances_cm, (std::vector<int>{101, 104, 105})) << "byte " << wrong;
    EXPECT_EQ(reader.checksumErrors(), wrong < 2 ? 0u : 1u) << "byte " << wrong;
  }
}

TEST(Tfmini, HeadersWithinTheDataAreNotTakenForFrames) {
  for (const unsigned distance_cm : {0x59u, 0x159u, 0x359u}) {
    std::string stream;
    for (unsigned i = 0; i < 40; ++i) stream += tfminiFrame(distance_cm, 0x5959 + i, 0x5959);
    for (std::size_t from = 0; from < 9; ++from) {
      TfminiReader reader(0.01);
      const auto readings = readingsOf(reader, stream.substr(from));
      EXPECT_GE(readings.size(), 36u) << from;
      for (const auto& reading : readings) {
        EXPECT_DOUBLE_EQ(reading.measurement.range_m, 0.01 * distance_cm) << "entered at byte " << from;
      }
    }
  }
}

TEST(Tfmini, GarbageGivesNoReadingAndHoldsNoMemory) {
  TfminiReader reader(0.01);
  EXPECT_TRUE(readingsOf(reader, std::string(100000, '\x59')).empty());
  EXPECT_TRUE(readingsOf(reader, std::string(100000, '\0')).empty());
  EXPECT_LT(reader.held(), TfminiReader::kFrameBytes);
  EXPECT_EQ(reader.refused() + reader.held(), 200000u);
}

}  // namespace
}  // namespace flight_corridor::serial
