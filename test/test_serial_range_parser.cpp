#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "serial/range_parser.hpp"
#include "support/wire.hpp"

namespace flight_corridor::serial {
namespace {

using test_support::lead;
using test_support::wireBytes;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kByte_s = 10.0 / 115200;

RangeLimits limitsOf(Protocol protocol) {
  const SensorDefaults defaults = defaultsOf(protocol);
  return {defaults.min_range_m, defaults.max_range_m, defaults.strength_min};
}

/// A parser, and what came out of it.
struct Wire {
  explicit Wire(Protocol protocol)
      : parser(protocol, limitsOf(protocol), kByte_s, metresOf(unitsOf(protocol).front())) {}

  void send(const std::string& bytes, double read_s = 0.0) {
    parser.feed(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), read_s, readings);
  }

  RangeParser parser;
  std::vector<WireReading> readings;
};

/// What may be on a line: readings, noise, halves, wrong checksums.
std::string noisyStream(Protocol protocol, unsigned seed) {
  std::mt19937 random(seed);
  std::string stream = lead(protocol);
  for (int i = 0; i < 300; ++i) {
    std::string frame = wireBytes(protocol, 100 + random() % 500);
    switch (random() % 8) {
      case 0:
        frame.resize(random() % frame.size());
        break;
      case 1:
        frame[random() % frame.size()] = static_cast<char>(random());
        break;
      case 2:
        for (unsigned n = random() % 20; n > 0; --n) frame.push_back(static_cast<char>(random()));
        break;
      default:
        break;
    }
    stream += frame;
  }
  return stream;
}

class EveryProtocol : public testing::TestWithParam<Protocol> {};
INSTANTIATE_TEST_SUITE_P(RangeParser, EveryProtocol, testing::ValuesIn(kProtocols),
                         [](const auto& info) { return std::string(toString(info.param)); });

TEST_P(EveryProtocol, DistancesComeOutAsTheyWentIn) {
  Wire wire(GetParam());
  wire.send(lead(GetParam()));
  for (unsigned distance_cm = 30; distance_cm < 800; ++distance_cm) wire.send(wireBytes(GetParam(), distance_cm));
  ASSERT_EQ(wire.readings.size(), 770u);
  for (unsigned i = 0; i < 770; ++i) EXPECT_DOUBLE_EQ(wire.readings[i].range_m, 0.01 * (30 + i));
  EXPECT_EQ(wire.parser.counts().readings, 770u);
  EXPECT_EQ(wire.parser.counts().refused_bytes, lead(GetParam()).size());
  EXPECT_EQ(wire.parser.counts().checksum_errors, 0u);
}

TEST_P(EveryProtocol, AFrameMayBeSplitAtAnyByte) {
  const std::string stream = lead(GetParam()) + wireBytes(GetParam(), 123) + wireBytes(GetParam(), 456);
  for (std::size_t cut = 0; cut <= stream.size(); ++cut) {
    Wire wire(GetParam());
    wire.send(stream.substr(0, cut));
    wire.send(stream.substr(cut));
    ASSERT_EQ(wire.readings.size(), 2u) << cut;
    EXPECT_DOUBLE_EQ(wire.readings[0].range_m, 1.23);
    EXPECT_DOUBLE_EQ(wire.readings[1].range_m, 4.56);
  }
}

TEST_P(EveryProtocol, HowTheStreamIsCutChangesNoReadingAndNoCount) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::string stream = noisyStream(GetParam(), seed);
    Wire whole(GetParam()), pieces(GetParam());
    whole.send(stream);
    std::mt19937 random(seed);
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t size = 1 + random() % 40;
      pieces.send(stream.substr(at, size));
      at += size;
    }
    ASSERT_EQ(whole.readings.size(), pieces.readings.size()) << seed;
    EXPECT_GT(whole.readings.size(), 50u);
    for (std::size_t i = 0; i < whole.readings.size(); ++i) {
      EXPECT_EQ(whole.readings[i].range_m, pieces.readings[i].range_m);
    }
    EXPECT_EQ(whole.parser.counts().refused_bytes, pieces.parser.counts().refused_bytes);
    EXPECT_EQ(whole.parser.counts().checksum_errors, pieces.parser.counts().checksum_errors);
  }
}

TEST_P(EveryProtocol, ReadingsKeepTheLimitsWhateverComes) {
  std::mt19937 random(5);
  Wire wire(GetParam());
  for (unsigned seed = 0; seed < 20; ++seed) wire.send(noisyStream(GetParam(), seed));
  for (int i = 0; i < 200000; ++i) wire.send(std::string(1, static_cast<char>(random())));
  const RangeLimits limits = limitsOf(GetParam());
  for (const WireReading& reading : wire.readings) {
    EXPECT_TRUE(!std::isfinite(reading.range_m) ||
                (limits.min_range_m <= reading.range_m && reading.range_m < limits.max_range_m));
  }
  const WireCounts& counts = wire.parser.counts();
  EXPECT_LE(counts.refused_bytes + wire.parser.held(), counts.bytes);
  EXPECT_LE(wire.parser.held(), LineReader::kLongest);
}

TEST_P(EveryProtocol, AStampIsTheArrivalOfTheFirstByte) {
  Wire wire(GetParam());
  wire.send(lead(GetParam()), 9.9);
  const std::string frame = wireBytes(GetParam(), 200);
  wire.send(frame, 10.0);
  ASSERT_EQ(wire.readings.size(), 1u);
  EXPECT_NEAR(wire.readings[0].stamp_s, 10.0 - static_cast<double>(frame.size()) * kByte_s, 1e-9);
  wire.send(frame.substr(0, 3), 11.0);
  wire.send(frame.substr(3), 11.5);
  ASSERT_EQ(wire.readings.size(), 2u);
  EXPECT_NEAR(wire.readings[1].stamp_s, 11.0 - 3 * kByte_s, 1e-9);
}

TEST_P(EveryProtocol, StampsAreOfTheTimeSinceTheReadBefore) {
  Wire wire(GetParam());
  wire.send(lead(GetParam()), 10.0);
  std::string late;
  for (int i = 0; i < 50; ++i) late += wireBytes(GetParam(), 200);
  wire.send(late, 10.001);  // more than the wire carries in a millisecond: they cannot be older than the read before
  ASSERT_EQ(wire.readings.size(), 50u);
  double previous_s = 10.0;
  for (const WireReading& reading : wire.readings) {
    EXPECT_GE(reading.stamp_s, previous_s);
    EXPECT_LE(reading.stamp_s, 10.001);
    previous_s = reading.stamp_s;
  }
  wire.send(wireBytes(GetParam(), 200), 5.0);  // the clock was set back
  EXPECT_LE(wire.readings.back().stamp_s, 5.0);
}

TEST_P(EveryProtocol, OneKilohertzIsReadWhole) {
  Wire wire(GetParam());
  wire.send(lead(GetParam()), 100.0);
  for (int i = 1; i <= 10000; ++i) wire.send(wireBytes(GetParam(), 100 + i % 500), 100.0 + 1e-3 * i);
  ASSERT_EQ(wire.readings.size(), 10000u);
  for (int i = 1; i < 10000; ++i) {
    EXPECT_NEAR(wire.readings[i].stamp_s - wire.readings[i - 1].stamp_s, 1e-3, 2 * kByte_s);
  }
}

TEST_P(EveryProtocol, ANewStreamDoesNotContinueTheOld) {
  Wire wire(GetParam());
  const std::string frame = wireBytes(GetParam(), 200);
  wire.send(lead(GetParam()) + frame.substr(0, 2));
  wire.parser.restart();
  EXPECT_EQ(wire.parser.held(), 0u);
  EXPECT_EQ(wire.parser.counts().refused_bytes, wire.parser.counts().bytes);
  wire.send(frame.substr(2));
  EXPECT_TRUE(wire.readings.empty());
}

TEST(RangeLimits, EachKindOfNoDistanceIsRep117s) {
  const RangeLimits limits{0.3, 8.0, 100.0};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(limitedRange({2.0, 500.0}, limits), 2.0);
  EXPECT_EQ(limitedRange({2.0, 100.0}, limits), 2.0);
  EXPECT_EQ(limitedRange({2.0, nan}, limits), 2.0) << "no strength is reported";
  EXPECT_TRUE(std::isnan(limitedRange({2.0, 99.0}, limits))) << "weak";
  EXPECT_TRUE(std::isnan(limitedRange({0.0, 99.0}, limits))) << "weak, as a TF-Luna says it";
  EXPECT_TRUE(std::isnan(limitedRange({nan, 500.0}, limits)));
  EXPECT_TRUE(std::isnan(limitedRange({-1.0, 500.0}, limits)));
  EXPECT_EQ(limitedRange({0.3, 500.0}, limits), 0.3);
  EXPECT_EQ(limitedRange({0.29, 500.0}, limits), -kInfinity);
  EXPECT_EQ(limitedRange({0.0, 500.0}, limits), -kInfinity);
  EXPECT_EQ(limitedRange({8.0, 500.0}, limits), kInfinity) << "where sensors clip";
  EXPECT_EQ(limitedRange({kInfinity, 3.0}, limits), kInfinity) << "no return";
}

TEST(RangeParser, ALostSignalIsNoDistance) {
  Wire sf11(Protocol::Lightware);
  sf11.send("\n130.00\r\n");  // SF11/C manual, menu item n
  ASSERT_EQ(sf11.readings.size(), 1u);
  EXPECT_EQ(sf11.readings[0].range_m, kInfinity);
  Wire tfmini(Protocol::Tfmini);
  tfmini.send(lead(Protocol::Tfmini) + test_support::tfminiFrame(0xffff, 50) + test_support::tfminiFrame(0, 50));
  ASSERT_EQ(tfmini.readings.size(), 2u);
  for (const WireReading& reading : tfmini.readings) EXPECT_TRUE(std::isnan(reading.range_m));
}

TEST(RangeParser, WrongChecksumsAreCountedAndRefused) {
  Wire wire(Protocol::LidarLite);
  wire.send("\nR,100,50*00\r\n" + wireBytes(Protocol::LidarLite, 300));
  ASSERT_EQ(wire.readings.size(), 1u);
  EXPECT_DOUBLE_EQ(wire.readings[0].range_m, 3.0);
  EXPECT_EQ(wire.parser.counts().checksum_errors, 1u);
  EXPECT_EQ(wire.parser.counts().refused_bytes, 14u);
}

}  // namespace
}  // namespace flight_corridor::serial
