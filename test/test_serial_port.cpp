#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <optional>
#include <string>

#include "serial/serial_port.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/temporary_folder.hpp"

namespace flight_corridor::serial {
namespace {

using flight_corridor::test_support::PseudoTerminal;

constexpr double kShort_s = 0.05, kLong_s = 5.0;

class SerialPortTest : public testing::Test {
 protected:
  std::string readAll(double timeout_s) {
    std::uint8_t bytes[256];
    return std::string(reinterpret_cast<char*>(bytes), port_.read(bytes, sizeof bytes, timeout_s));
  }

  flight_corridor::test_support::TemporaryFolder folder_;
  const std::string path_ = folder_.path("lidar");
  SerialPort port_;
};

TEST_F(SerialPortTest, BytesComeAsTheyAreSent) {
  const PseudoTerminal sensor(path_);
  ASSERT_EQ(port_.open(path_, 115200), "");
  const std::string all{"\x59\0\r\n\x03\x04\x11\x13\x1a\xff\x7f", 11};  // what terminals like to keep for themselves
  sensor.send(all);
  EXPECT_EQ(readAll(kLong_s), all);
  EXPECT_EQ(sensor.received(), "") << "nothing is echoed";
  port_.write("d");
  EXPECT_EQ(sensor.received(), "d");
}

TEST_F(SerialPortTest, SilenceEndsInTime) {
  const PseudoTerminal sensor(path_);
  ASSERT_EQ(port_.open(path_, 115200), "");
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(readAll(kShort_s), "");
  EXPECT_TRUE(port_.isOpen());
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST_F(SerialPortTest, EveryRateCanBeSet) {
  const PseudoTerminal sensor(path_);
  for (const int rate : baudRates()) EXPECT_EQ(port_.open(path_, rate), "") << rate;
  EXPECT_NE(port_.open(path_, 12345), "");
  EXPECT_FALSE(port_.isOpen());
}

TEST_F(SerialPortTest, APulledPlugClosesThePortAndAnotherOpensIt) {
  std::optional<PseudoTerminal> sensor(path_);
  ASSERT_EQ(port_.open(path_, 115200), "");
  sensor->send("last");
  sensor.reset();
  for (int i = 0; i < 100 && port_.isOpen(); ++i) readAll(kShort_s);
  EXPECT_FALSE(port_.isOpen());
  EXPECT_NE(port_.lossReason(), "");
  EXPECT_EQ(readAll(kShort_s), "");
  port_.write("d");
  EXPECT_NE(port_.open(path_, 115200), "");
  sensor.emplace(path_);
  ASSERT_EQ(port_.open(path_, 115200), "");
  EXPECT_EQ(port_.lossReason(), "");
  sensor->send("first");
  EXPECT_EQ(readAll(kLong_s), "first");
}

TEST_F(SerialPortTest, WhatIsNoPortIsNotOpened) {
  std::ofstream(path_) << "12.34\n";
  EXPECT_EQ(port_.open(path_, 115200), "not a serial port");
  EXPECT_EQ(port_.open(folder_.path("missing"), 115200), "No such file or directory");
  EXPECT_NE(port_.open(folder_.path(""), 115200), "");
  EXPECT_FALSE(port_.isOpen());
}

TEST_F(SerialPortTest, ASensorThatNobodyHearsDoesNotHoldTheWriter) {
  const PseudoTerminal sensor(path_);
  ASSERT_EQ(port_.open(path_, 115200), "");
  for (int i = 0; i < 1000; ++i) port_.write(std::string(1000, 'd'));
  EXPECT_TRUE(port_.isOpen());
}

}  // namespace
}  // namespace flight_corridor::serial
