#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace flight_corridor::serial {

/// Rates that a port can be set to [baud].
const std::vector<int>& baudRates();

/// A serial port, raw, 8N1, without handshake. No call throws; each that waits ends in time. One thread.
class SerialPort {
 public:
  SerialPort() = default;
  ~SerialPort() { close(); }
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  /// Opens it exclusively; earlier bytes are dropped. If the driver can, it passes bytes on at once (FTDI's USB
  /// converters gather them for 16 ms).
  /// @param baud one of baudRates().
  /// @return the reason of a failure; "" if it is open.
  std::string open(const std::string& path, int baud);
  bool isOpen() const { return file_ >= 0; }
  void close();

  /// Waits for bytes.
  /// @return the number of bytes; 0 if none came in this time, or if the port is gone: then it is closed.
  std::size_t read(std::uint8_t* bytes, std::size_t capacity, double timeout_s);

  /// Sends as much as the port accepts at once; the rest is lost.
  void write(const std::string& text);

  /// Why the port was lost; "" otherwise.
  const std::string& lossReason() const { return loss_reason_; }

 private:
  void lose(const std::string& reason);

  int file_ = -1;
  std::string loss_reason_;
};

}  // namespace flight_corridor::serial
