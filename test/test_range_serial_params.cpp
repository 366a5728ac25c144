#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>

#include "ros/range_serial_params.hpp"
#include "support/contains.hpp"

namespace flight_corridor_ros {
namespace {

using flight_corridor::test_support::contains;

namespace serial = flight_corridor::serial;

std::string complaintAboutSensor(Values values) {
  values.emplace("protocol", std::string("tfmini"));
  try {
    makeRangeSerialConfig(values);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(RangeSerialParams, EveryProtocolHasItsSensorsDefaults) {
  for (const auto protocol : serial::kProtocols) {
    const RangeSerialConfig config = makeRangeSerialConfig({{"protocol", std::string(toString(protocol))}});
    EXPECT_EQ(config.protocol, protocol);
    EXPECT_EQ(config.field_of_view_rad, defaultsOf(protocol).field_of_view_rad);
    EXPECT_EQ(config.limits.min_range_m, defaultsOf(protocol).min_range_m);
    EXPECT_EQ(config.limits.max_range_m, defaultsOf(protocol).max_range_m);
    EXPECT_EQ(config.limits.strength_min, defaultsOf(protocol).strength_min);
  }
}

TEST(RangeSerialParams, ValuesReplaceDefaults) {
  const RangeSerialConfig config = makeRangeSerialConfig({{"protocol", std::string("lightware")},
                                                          {"port", std::string("/dev/lidar")},
                                                          {"baud", 57600},
                                                          {"frame_id", std::string("sf11")},
                                                          {"field_of_view_rad", 0.01},
                                                          {"min_range_m", 1},
                                                          {"max_range_m", 50.0},
                                                          {"strength_min", 0},
                                                          {"unit", std::string("m")},
                                                          {"wake", std::string("www")},
                                                          {"request_hz", 20},
                                                          {"silence_s", 1.5}});
  EXPECT_EQ(config.port, "/dev/lidar");
  EXPECT_EQ(config.baud, 57600);
  EXPECT_EQ(config.frame_id, "sf11");
  EXPECT_EQ(config.field_of_view_rad, 0.01);
  EXPECT_EQ(config.limits.min_range_m, 1.0);
  EXPECT_EQ(config.limits.max_range_m, 50.0);
  EXPECT_EQ(config.request_hz, 20.0);
  EXPECT_EQ(config.silence_s, 1.5);
  EXPECT_EQ(config.unit, "m");
  EXPECT_EQ(config.wake, "www");
}

TEST(RangeSerialParams, TheUnitIsOneThatTheProtocolsSensorsHave) {
  const auto unitOf = [](const char* protocol, const char* unit) {
    return makeRangeSerialConfig({{"protocol", std::string(protocol)}, {"unit", std::string(unit)}}).unit;
  };
  EXPECT_EQ(unitOf("tfmini", "cm"), "cm");
  EXPECT_EQ(unitOf("tfmini", "mm"), "mm");
  EXPECT_EQ(unitOf("lightware", "m"), "m");
  EXPECT_EQ(unitOf("lidar_lite", "cm"), "cm");
  EXPECT_EQ(makeRangeSerialConfig({{"protocol", std::string("tfmini")}}).unit, "cm");
  for (const char* unit : {"", "m", "MM", "inch", "0.001"}) {
    const std::string complaint = complaintAboutSensor({{"unit", std::string(unit)}});
    EXPECT_TRUE(contains(complaint, "unit: cm or mm, as protocol tfmini has it (\"" + std::string(unit) + "\")"))
        << complaint;
  }
  EXPECT_TRUE(contains(complaintAboutSensor({{"unit", 0.001}}), "unit: expects a text (0.001)"));
  EXPECT_EQ(serial::metresOf("m"), 1.0);
  EXPECT_EQ(serial::metresOf("cm"), 0.01);
  EXPECT_EQ(serial::metresOf("mm"), 0.001);
  EXPECT_THROW(unitOf("lightware", "mm"), std::invalid_argument);
  EXPECT_THROW(unitOf("lidar_lite", "mm"), std::invalid_argument);
}

TEST(RangeSerialParams, ASensorIsWokenByBytesOrByAText) {
  const auto wakeOf = [](const std::string& text) {
    return makeRangeSerialConfig({{"protocol", std::string("tfmini")}, {"wake", text}}).wake;
  };
  EXPECT_EQ(wakeOf(""), "");
  EXPECT_EQ(wakeOf("0x5A 0x04 0x11 0x6F"), "\x5a\x04\x11\x6f");
  EXPECT_EQ(wakeOf("0x00 0xff 0xA"), std::string("\0\xff\n", 3));
  EXPECT_EQ(wakeOf("www\\r\\n"), "www\r\n");
  EXPECT_EQ(wakeOf("www\r\n"), "www\r\n");
  EXPECT_EQ(wakeOf("%C,1\\q\\"), "%C,1\\q\\");
  for (const char* text : {"0x", "0x5A 04", "0x5A 0x100", "0x5A,0x04", "0x5g"}) {
    const std::string complaint = complaintAboutSensor({{"wake", std::string(text)}});
    EXPECT_TRUE(contains(complaint, "wake: bytes, each from 0x00 to 0xFF, or a text (\"" + std::string(text) + "\")"))
        << complaint;
  }
}

TEST(RangeSerialParams, AProtocolIsNeeded) {
  try {
    makeRangeSerialConfig({});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_TRUE(contains(error.what(), "protocol: missing; one of lightware, tfmini, lidar_lite")) << error.what();
  }
  EXPECT_TRUE(contains(complaintAboutSensor({{"protocol", std::string("sonar")}}),
                       "protocol: one of lightware, tfmini, lidar_lite (\"sonar\")"));
  EXPECT_TRUE(contains(complaintAboutSensor({{"protocol", 7}}), "protocol: one of lightware, tfmini, lidar_lite (7)"));
}

TEST(RangeSerialParams, EveryWrongValueIsNamedWithWhatIsAllowed) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto complains = [](const Values& values, const std::string& part) {
    const std::string complaint = complaintAboutSensor(values);
    EXPECT_TRUE(contains(complaint, part)) << "\"" << complaint << "\" lacks \"" << part << "\"";
  };
  complains({{"prot", 1}}, "prot: unknown key (1)");
  complains({{"port", std::string()}}, "port: a device, e.g. /dev/ttyUSB0 (\"\")");
  complains({{"baud", 12345}}, "baud: one of 9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600 (12345)");
  complains({{"baud", 115200.0}}, "baud: expects an integer");
  complains({{"frame_id", std::string()}}, "frame_id: a frame's name");
  complains({{"frame_id", std::string("/range_link")}}, "frame_id: a frame's name");
  complains({{"strength_min", std::string("high")}}, "strength_min: expects a number (\"high\")");
  complains({{"min_range_m", 9.0}}, "min_range_m: 0 or more, below max_range_m (9)");
  for (const double value : {nan, -1.0, infinity}) {
    for (const char* key : {"field_of_view_rad", "min_range_m", "strength_min", "request_hz", "silence_s"}) {
      complains({{key, value}}, std::string(key) + ": ");
    }
  }
  complains({{"max_range_m", nan}}, "max_range_m: ");
  complains({{"max_range_m", infinity}}, "max_range_m: ");
  complains({{"request_hz", 10}}, "request_hz: 0: protocol tfmini cannot be polled (10)");
  complains({{"protocol", std::string("lightware")}, {"strength_min", 1}},
            "strength_min: 0: protocol lightware reports no strength (1)");
}

TEST(RangeSerialParams, AllThatIsWrongIsNamedAtOnce) {
  const std::string complaint = complaintAboutSensor({{"baud", 1}, {"silence_s", 0}, {"prot", 1}, {"protocol", 1}});
  for (const char* key : {"baud", "silence_s", "prot", "protocol"}) {
    EXPECT_TRUE(contains(complaint, std::string("\n  ") + key + ": ")) << complaint;
  }
}

}  // namespace
}  // namespace flight_corridor_ros
