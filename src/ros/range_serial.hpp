#pragma once

#include <ros/publisher.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "ros/heartbeat.hpp"
#include "ros/range_serial_diagnostics.hpp"
#include "ros/range_serial_params.hpp"
#include "serial/range_parser.hpp"
#include "serial/serial_port.hpp"

namespace flight_corridor_ros {

/// Reads a LiDAR on a serial port and publishes `range`. The port may come and go. One thread.
class RangeSerial {
 public:
  /// @throws std::invalid_argument naming every wrong parameter.
  RangeSerial(const ros::NodeHandle& node, const ros::NodeHandle& private_node);

  /// Waits for bytes, 50 ms at most, and publishes their readings.
  void step();

 private:
  void openWhenDue();
  void receive(std::size_t size);
  void publish(const flight_corridor::serial::WireReading& reading);
  double waitSeconds() const;
  void requestWhenDue();
  void wake();
  void wakeInSilence();
  void noticeLoss();
  void warnOfSilence();
  std::string silenceCause() const;
  void warnOfInvalidRanges();
  std::string invalidCause(const flight_corridor::serial::WireReading& reading) const;

  RangeSerialConfig config_;
  flight_corridor::serial::SerialPort port_;
  flight_corridor::serial::RangeParser parser_;
  std::array<std::uint8_t, 4096> bytes_{};
  std::vector<flight_corridor::serial::WireReading> readings_;
  std::string trouble_ = "not opened yet";           // of the port; "" while it is open
  double next_opening_s_, next_request_s_, wake_s_;  // by a steady clock
  double heard_s_;                                   // the newest reading, or the start
  double valid_s_;                                   // the newest that is no NaN, or what came first after a silence
  std::uint64_t heard_bytes_ = 0;                    // that had come by then
  Throttle opening_info_, loss_warning_, silence_warning_, invalid_warning_;
  RangeSerialDiagnostics diagnostics_;
  ros::Publisher publisher_;
};

}  // namespace flight_corridor_ros
