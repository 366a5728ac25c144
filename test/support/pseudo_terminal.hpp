#pragma once

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>

namespace flight_corridor::test_support {

/// A serial line: this end is the sensor's; the other has a name like a port's.
class PseudoTerminal {
 public:
  /// @param link a path that leads to the port for as long as this lives, as udev makes them.
  explicit PseudoTerminal(const std::string& link) : link_(link) {
    if (file_ < 0 || grantpt(file_) != 0 || unlockpt(file_) != 0) throw std::runtime_error("no pseudo-terminal");
    std::filesystem::remove(link_);
    std::filesystem::create_symlink(ptsname(file_), link_);
  }
  ~PseudoTerminal() {
    std::filesystem::remove(link_);
    close(file_);
  }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  /// Sends all, or as much as is taken within a second: without a reader a line is full at some time.
  void send(const std::string& bytes) const {
    for (std::size_t sent = 0, waits = 0; sent < bytes.size() && waits < 100;) {
      const ssize_t size = write(file_, bytes.data() + sent, bytes.size() - sent);
      if (size > 0) sent += static_cast<std::size_t>(size);
      if (size <= 0) std::this_thread::sleep_for(std::chrono::milliseconds(10)), ++waits;
    }
  }

  /// What has come from the other end.
  std::string received() const {
    char bytes[4096];
    const ssize_t size = read(file_, bytes, sizeof bytes);
    return size > 0 ? std::string(bytes, static_cast<std::size_t>(size)) : "";
  }

 private:
  std::string link_;
  int file_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
};

}  // namespace flight_corridor::test_support
