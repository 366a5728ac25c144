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

  /// Opens it for this process alone; what came before is dropped. Where the driver can, bytes are not gathered before
  /// they are handed on (USB converters of FTDI do so for 16 ms).
  /// @param baud one of baudRates().
  /// @return what was in the way; "" when it is open.
  std::string open(const std::string& path, int baud);
  bool isOpen() const { return file_ >= 0; }
  void close();

  /// Waits for bytes.
  /// @return how many came; 0 when none did in this time, or when the port is gone: then it is closed.
  std::size_t read(std::uint8_t* bytes, std::size_t capacity, double timeout_s);

  /// Sends what the port takes at once: what it does not take is lost.
  void write(const std::string& text);

  /// Why the port went: "" while it has not.
  const std::string& lossReason() const { return loss_reason_; }

 private:
  void lose(const std::string& reason);

  int file_ = -1;
  std::string loss_reason_;
};

}  // namespace flight_corridor::serial
