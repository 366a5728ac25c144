#include <diagnostic_msgs/DiagnosticStatus.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/Range.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "support/child_process.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/range_serial_listener.hpp"
#include "support/temporary_folder.hpp"
#include "support/wire.hpp"

namespace {

namespace serial = flight_corridor::serial;
using flight_corridor::test_support::ChildProcess;
using flight_corridor::test_support::PseudoTerminal;
using flight_corridor_ros::test_support::RangeSerialListener;
using serial::Protocol;
using serial::test_support::wireBytes;

constexpr double kPatience_s = 30.0;  // a loaded machine may need seconds for a first answer
constexpr double kShutdown_s = 10.0;

class RangeSerialNode : public testing::TestWithParam<Protocol> {
 protected:
  using Parameters = std::vector<std::string>;

  /// Starts the node on a port that need not be there.
  void start(Parameters parameters = {}) {
    static int count = 0;
    const std::string name = std::string("under_test_") + std::to_string(++count);
    listener_ = std::make_unique<RangeSerialListener>(name);
    parameters.insert(parameters.begin(), {RANGE_SERIAL_PROGRAM, "__name:=" + name, "range:=/" + name + "/range",
                                           "_port:=" + link_, std::string("_protocol:=") + toString(GetParam())});
    node_ = std::make_unique<ChildProcess>(parameters, folder_.path("output"));
  }

  /// Whether it comes to hold while the sensor sends these bytes every 20 ms.
  bool becomesTrue(const std::function<bool()>& condition, const std::string& bytes = "") {
    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kPatience_s);
    while (ros::ok() && ros::WallTime::now() < deadline) {
      if (sensor_ && !bytes.empty()) sensor_->send(bytes);
      ros::WallDuration(0.02).sleep();
      ros::spinOnce();
      if (condition()) return true;
    }
    return false;
  }

  void wait(double seconds) {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(seconds);
    while (ros::WallTime::now() < end) {
      ros::WallDuration(0.02).sleep();
      ros::spinOnce();
    }
  }

  bool readsNow(unsigned distance_cm) {
    listener_->ranges.clear();
    return becomesTrue(
        [&] {
          return !listener_->ranges.empty() && std::abs(listener_->ranges.back().range - 0.01 * distance_cm) < 1e-5;
        },
        wireBytes(GetParam(), distance_cm));
  }

  std::string output() const {
    std::stringstream text;
    text << std::ifstream(folder_.path("output")).rdbuf();
    return text.str();
  }

  flight_corridor::test_support::TemporaryFolder folder_;
  const std::string link_ = folder_.path("lidar");
  std::optional<PseudoTerminal> sensor_;
  std::unique_ptr<RangeSerialListener> listener_;
  std::unique_ptr<ChildProcess> node_;
};
INSTANTIATE_TEST_SUITE_P(EveryProtocol, RangeSerialNode, testing::ValuesIn(serial::kProtocols),
                         [](const auto& info) { return std::string(toString(info.param)); });

TEST_P(RangeSerialNode, ReadingsComeOutAsRangesWithTheSensorsLimits) {
  sensor_.emplace(link_);
  start({"_frame_id:=lidar_frame"});
  ASSERT_TRUE(readsNow(321)) << output();
  const serial::SensorDefaults defaults = serial::defaultsOf(GetParam());
  const sensor_msgs::Range& range = listener_->ranges.back();
  EXPECT_EQ(range.header.frame_id, "lidar_frame");
  EXPECT_EQ(range.radiation_type, sensor_msgs::Range::INFRARED);
  EXPECT_FLOAT_EQ(range.field_of_view, static_cast<float>(defaults.field_of_view_rad));
  EXPECT_FLOAT_EQ(range.min_range, static_cast<float>(defaults.min_range_m));
  EXPECT_FLOAT_EQ(range.max_range, static_cast<float>(defaults.max_range_m));
  EXPECT_LT(range.header.stamp, listener_->arrivals.back());
  EXPECT_GT(range.header.stamp, listener_->arrivals.back() - ros::Duration(5.0));
}

TEST_P(RangeSerialNode, OutOfRangeIsNoNumber) {
  sensor_.emplace(link_);
  start();
  const auto newest = [this] { return listener_->ranges.empty() ? 0.0f : listener_->ranges.back().range; };
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(becomesTrue([&] { return newest() == infinity; }, wireBytes(GetParam(), 13000)));
  EXPECT_TRUE(becomesTrue([&] { return newest() == -infinity; }, wireBytes(GetParam(), 2)));
  if (GetParam() == Protocol::Tfmini) {
    EXPECT_TRUE(becomesTrue([&] { return std::isnan(newest()); }, serial::test_support::tfminiFrame(200, 99)));
  }
  ASSERT_TRUE(becomesTrue([&] { return listener_->status.number("readings without range") > 0; }));
}

TEST_P(RangeSerialNode, SilenceGivesNoReadingAndOneWarningWithTheRemedy) {
  sensor_.emplace(link_);
  start({"_silence_s:=0.5"});
  ASSERT_TRUE(readsNow(200)) << output();
  listener_->warnings.clear();
  ASSERT_TRUE(becomesTrue([this] { return !listener_->warnings.empty(); }));
  for (const char* part : {"no reading", "silence_s: 0.5", "no byte came", "wiring"}) {
    EXPECT_NE(listener_->warnings[0].find(part), std::string::npos) << part << " in: " << listener_->warnings[0];
  }
  listener_->ranges.clear();
  wait(3.0);
  EXPECT_TRUE(listener_->ranges.empty());
  EXPECT_EQ(listener_->warnings.size(), 1u) << "they are throttled";
  EXPECT_TRUE(becomesTrue([this] { return listener_->status.level == diagnostic_msgs::DiagnosticStatus::ERROR; }));
  EXPECT_EQ(listener_->status.summary, "no bytes");
}

TEST_P(RangeSerialNode, ReadingsWithoutARangeGiveOneWarningWithTheRemedy) {
  sensor_.emplace(link_);
  start({"_silence_s:=0.5"});
  ASSERT_TRUE(readsNow(200)) << output();
  struct Useless {
    std::string bytes;
    const char *value, *remedy;
  };
  const std::map<Protocol, std::vector<Useless>> kinds{
      {Protocol::Tfmini,
       {{serial::test_support::tfminiFrame(500, 0), "strength 0 is below strength_min (100)", "needs strength_min 0"},
        {serial::test_support::tfminiFrame(0xffff, 700), "error code -1", "open sky"},
        {serial::test_support::tfminiFrame(500, 0xffff), "strength 65535", "bright"},
        {serial::test_support::tfminiFrame(500, 60), "strength 60 is below strength_min (100)", "lower strength_min"}}},
      {Protocol::Lightware, {{"-3.00\r\n", "error code -3", "off and on"}, {"ld,0:-2\r\n", "error code -2", "manual"}}},
      {Protocol::LidarLite, {{serial::test_support::lidarLiteLine("E"), "does not answer the Arduino", "wiring"}}}};
  for (const Useless& useless : kinds.at(GetParam())) {
    const auto isNamed = [&](const std::string& text) {
      return text.find(useless.value) != std::string::npos && text.find(useless.remedy) != std::string::npos;
    };
    ASSERT_TRUE(becomesTrue([&] { return isNamed(listener_->status.summary); }, useless.bytes)) << useless.value;
    EXPECT_EQ(listener_->status.level, diagnostic_msgs::DiagnosticStatus::WARN);
    ASSERT_TRUE(becomesTrue(
        [&] {
          return std::any_of(listener_->warnings.begin(), listener_->warnings.end(), [&](const std::string& warning) {
            return isNamed(warning) && warning.find("(silence_s: 0.5)") != std::string::npos;
          });
        },
        useless.bytes))
        << useless.value;
  }
  listener_->warnings.clear();
  ASSERT_TRUE(becomesTrue([this] { return listener_->status.level == diagnostic_msgs::DiagnosticStatus::OK; },
                          wireBytes(GetParam(), 200)));
  EXPECT_TRUE(becomesTrue([this] { return listener_->status.level == diagnostic_msgs::DiagnosticStatus::OK; },
                          wireBytes(GetParam(), 13000)))
      << "nothing in range is a reading";
  EXPECT_TRUE(listener_->warnings.empty()) << listener_->warnings.front();
}

TEST_P(RangeSerialNode, ASensorIsWokenAtOpeningAndWhileItIsSilent) {
  sensor_.emplace(link_);
  start({"_silence_s:=0.5", "_wake:=0x5A 0x04 0x11 0x6F"});
  std::string received;
  ASSERT_TRUE(becomesTrue([&] { return (received += sensor_->received()).size() >= 8; })) << output();
  EXPECT_EQ(received.substr(0, 8), "\x5a\x04\x11\x6f\x5a\x04\x11\x6f");
  ASSERT_TRUE(readsNow(200));
  sensor_->received();
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(1.5);
  ASSERT_TRUE(becomesTrue([&] { return ros::WallTime::now() > end; }, wireBytes(GetParam(), 200)));
  EXPECT_EQ(sensor_->received(), "") << "it is awake";
  sensor_.reset();
  sensor_.emplace(link_);
  received.clear();
  ASSERT_TRUE(becomesTrue([&] { return (received += sensor_->received()).size() >= 4; })) << output();
}

TEST_P(RangeSerialNode, AnotherSensorsBytesAreNamedInTheWarning) {
  sensor_.emplace(link_);
  start({"_silence_s:=0.5"});
  const Protocol other = GetParam() == Protocol::Tfmini ? Protocol::Lightware : Protocol::Tfmini;
  const auto isNamed = [this] {
    for (const std::string& warning : listener_->warnings) {
      if (warning.find("bytes came, but no reading") != std::string::npos) return true;
    }
    return false;
  };
  EXPECT_TRUE(becomesTrue(isNamed, wireBytes(other, 200)));
  EXPECT_TRUE(listener_->ranges.empty());
}

TEST_P(RangeSerialNode, APulledPlugIsReportedAndReadingsComeAgainWithIt) {
  start();
  ASSERT_TRUE(becomesTrue([this] { return listener_->status.values["port state"] == "No such file or directory"; }));
  EXPECT_EQ(listener_->status.level, diagnostic_msgs::DiagnosticStatus::ERROR);
  for (unsigned opening = 1; opening <= 3; ++opening) {
    sensor_.emplace(link_);
    ASSERT_TRUE(readsNow(100 * opening)) << output();
    sensor_.reset();
    const auto isGone = [&] {
      return listener_->status.number("openings") == opening && listener_->status.summary.rfind("port closed", 0) == 0;
    };
    ASSERT_TRUE(becomesTrue(isGone)) << output();
  }
}

TEST_P(RangeSerialNode, WrongBytesAreCountedAndNoReadings) {
  sensor_.emplace(link_);
  start();
  ASSERT_TRUE(readsNow(200)) << output();
  std::string wrong = wireBytes(GetParam(), 200);
  wrong[2] = static_cast<char>(wrong[2] ^ 0x40);  // of a line without checksum: no digit
  wait(0.5);
  listener_->ranges.clear();
  EXPECT_TRUE(becomesTrue([this] { return listener_->status.number("bytes refused") > 100; }, wrong));
  if (GetParam() != Protocol::Lightware) {
    EXPECT_TRUE(becomesTrue([this] { return listener_->status.number("checksum errors") > 0; }));
  }
  EXPECT_TRUE(listener_->ranges.empty());
  EXPECT_TRUE(readsNow(300)) << "and it is in step again";
}

TEST_P(RangeSerialNode, OneKilohertzComesWholeAndInOrder) {
  sensor_.emplace(link_);
  start({"_baud:=921600"});
  ASSERT_TRUE(readsNow(200)) << output();
  wait(0.5);
  listener_->ranges.clear();
  const ros::WallTime begin = ros::WallTime::now();
  constexpr unsigned kReadings = 3000;
  for (unsigned i = 0; i < kReadings; ++i) {
    sensor_->send(wireBytes(GetParam(), 100 + i % 500));
    ros::spinOnce();
    ros::WallTime::sleepUntil(begin + ros::WallDuration(1e-3 * (i + 1)));
  }
  EXPECT_TRUE(becomesTrue([this] { return listener_->ranges.size() >= kReadings; })) << listener_->ranges.size();
  ASSERT_EQ(listener_->ranges.size(), kReadings);
  for (unsigned i = 0; i < kReadings; ++i) {
    ASSERT_FLOAT_EQ(listener_->ranges[i].range, 0.01f * static_cast<float>(100 + i % 500)) << i;
    ASSERT_GE(listener_->ranges[i].header.stamp, listener_->ranges[i == 0 ? 0 : i - 1].header.stamp) << i;
  }
}

TEST_P(RangeSerialNode, DiagnosticsTellRateAndStrength) {
  sensor_.emplace(link_);
  start();
  ASSERT_TRUE(
      becomesTrue([this] { return listener_->status.number("readings [Hz]") > 5.0; }, wireBytes(GetParam(), 200)))
      << listener_->status.summary << ", " << listener_->ranges.size() << " ranges; " << output();
  EXPECT_EQ(listener_->status.level, diagnostic_msgs::DiagnosticStatus::OK) << listener_->status.summary;
  EXPECT_EQ(listener_->status.values["port state"], "open");
  EXPECT_EQ(listener_->status.values["port"], link_);
  EXPECT_NEAR(listener_->status.number("range [m]"), 2.0, 1e-5);
  EXPECT_EQ(std::isnan(listener_->status.number("strength")), !serial::hasStrength(GetParam()));
}

TEST_P(RangeSerialNode, ItEndsAtOnceWithAndWithoutAPort) {
  start();
  ASSERT_TRUE(becomesTrue([this] { return listener_->status.level >= 0; })) << output();
  node_->interrupt();
  EXPECT_EQ(node_->wait(kShutdown_s), 0) << output();
  sensor_.emplace(link_);
  start();
  ASSERT_TRUE(readsNow(200)) << output();
  node_->interrupt();  // the sensor is silent
  EXPECT_EQ(node_->wait(kShutdown_s), 0) << output();
}

TEST_P(RangeSerialNode, AWrongParameterStopsItWithItsName) {
  start({"_baud:=12345", "_min_range:=1.0"});
  EXPECT_EQ(node_->wait(kPatience_s), 1);
  for (const char* part : {"baud: one of 9600", "(12345)", "min_range: unknown key"}) {
    EXPECT_NE(output().find(part), std::string::npos) << part << " in: " << output();
  }
}

TEST(RangeSerialWire, ATfminiInMillimetresAndATf03AreReadAsTheDocumentsSay) {
  flight_corridor::test_support::TemporaryFolder folder;
  const auto reads = [&](const std::string& name, const std::vector<std::string>& more, const std::string& bytes) {
    const PseudoTerminal sensor(folder.path("lidar"));
    RangeSerialListener listener(name);
    std::vector<std::string> parameters{RANGE_SERIAL_PROGRAM, "__name:=" + name, "range:=/" + name + "/range",
                                        "_protocol:=tfmini", "_port:=" + folder.path("lidar")};
    parameters.insert(parameters.end(), more.begin(), more.end());
    const ChildProcess node(parameters, folder.path("output"));
    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kPatience_s);
    while (listener.ranges.empty() && ros::WallTime::now() < deadline) {
      sensor.send(bytes);
      ros::WallDuration(0.02).sleep();
      ros::spinOnce();
    }
    return listener.ranges.empty() ? 0.0f : listener.ranges.back().range;
  };
  EXPECT_FLOAT_EQ(reads("tfmini", {"_unit:=mm"}, serial::test_support::tfminiFrame(4321, 500)), 4.321f);
  const std::vector<std::string> tf03{"_strength_min:=0", "_max_range_m:=180"};
  EXPECT_FLOAT_EQ(reads("tf03", tf03, serial::test_support::tfminiFrame(4321, 0)), 43.21f);
  EXPECT_EQ(reads("tf03", tf03, serial::test_support::tfminiFrame(18000, 0)), std::numeric_limits<float>::infinity());
}

TEST(RangeSerialWire, ALightwareThatLooksToTheSkyHasNothingInRange) {
  flight_corridor::test_support::TemporaryFolder folder;
  const PseudoTerminal sensor(folder.path("lidar"));
  RangeSerialListener listener("sky");
  const ChildProcess node({RANGE_SERIAL_PROGRAM, "__name:=sky", "range:=/sky/range", "_protocol:=lightware",
                           "_silence_s:=0.5", "_port:=" + folder.path("lidar")},
                          folder.path("output"));
  const ros::WallTime begin = ros::WallTime::now();
  while (ros::WallTime::now() < begin + ros::WallDuration(kPatience_s) && listener.ranges.size() < 150) {
    sensor.send("-1.00\r\n-1.0\r\n-1\r\n");
    ros::WallDuration(0.05).sleep();
    ros::spinOnce();
  }
  ASSERT_GE(listener.ranges.size(), 150u);
  for (const auto& range : listener.ranges) EXPECT_EQ(range.range, std::numeric_limits<float>::infinity());
  EXPECT_TRUE(listener.warnings.empty()) << listener.warnings.front();
}

/// Of the protocols in which a sensor may wait to be asked.
class AskingRangeSerialNode : public RangeSerialNode {};
INSTANTIATE_TEST_SUITE_P(OnDemand, AskingRangeSerialNode, testing::Values(Protocol::Lightware));

TEST_P(AskingRangeSerialNode, ASensorThatWaitsToBeAskedIsAsked) {
  sensor_.emplace(link_);
  start({"_request_hz:=50"});
  int answers = 0;
  const auto answer = [&] {
    for (const char byte : sensor_->received()) {
      EXPECT_EQ(byte, 'd');
      sensor_->send(wireBytes(GetParam(), 200));
      ++answers;
    }
    return answers >= 100;
  };
  ASSERT_TRUE(becomesTrue(answer)) << answers;
  EXPECT_TRUE(becomesTrue([this] { return listener_->ranges.size() >= 50; })) << listener_->ranges.size();
}

TEST(RangeSerialLaunch, TheLaunchFilesNodeWaitsForItsPort) {
  RangeSerialListener listener("launched");
  const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kPatience_s);
  while (listener.status.level < 0 && ros::WallTime::now() < deadline) {
    ros::WallDuration(0.05).sleep();
    ros::spinOnce();
  }
  EXPECT_EQ(listener.status.values["port state"], "No such file or directory");
  EXPECT_EQ(listener.status.values["port"], "/dev/no_such_port");
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "rostest_range_serial");
  const ros::NodeHandle node;  // from one case to the next
  return RUN_ALL_TESTS();
}
