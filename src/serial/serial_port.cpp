#include "serial/serial_port.hpp"

#include <fcntl.h>
#include <linux/serial.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <map>

namespace flight_corridor::serial {

namespace {

const std::map<int, speed_t>& speeds() {
  static const std::map<int, speed_t> speeds{{9600, B9600},     {19200, B19200},   {38400, B38400},
                                             {57600, B57600},   {115200, B115200}, {230400, B230400},
                                             {460800, B460800}, {921600, B921600}};
  return speeds;
}

std::string reasonOf(int error) { return std::strerror(error); }

/// Whether an error of read() or poll() goes by itself.
bool isPassing(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

/// @return false with errno when the device has no such settings.
bool makeRaw(int file, speed_t speed) {
  termios settings{};
  if (tcgetattr(file, &settings) != 0) return false;
  cfmakeraw(&settings);
  settings.c_iflag |= INPCK;  // a byte with a framing error is read as 0, which no number holds
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
  settings.c_cc[VMIN] = 1;  // nothing to read is EAGAIN, not the end of the file
  settings.c_cc[VTIME] = 0;
  return cfsetspeed(&settings, speed) == 0 && tcsetattr(file, TCSANOW, &settings) == 0 && tcflush(file, TCIFLUSH) == 0;
}

/// Best effort: most drivers have nothing to set.
void askForLowLatency(int file) {
  serial_struct settings{};
  if (ioctl(file, TIOCGSERIAL, &settings) != 0) return;
  settings.flags |= ASYNC_LOW_LATENCY;
  ioctl(file, TIOCSSERIAL, &settings);
}

}  // namespace

const std::vector<int>& baudRates() {
  static const std::vector<int> rates = [] {
    std::vector<int> all;
    for (const auto& speed : speeds()) all.push_back(speed.first);
    return all;
  }();
  return rates;
}

std::string SerialPort::open(const std::string& path, int baud) {
  close();
  loss_reason_.clear();
  const auto speed = speeds().find(baud);
  if (speed == speeds().end()) return "unsupported baud rate: " + std::to_string(baud) + " baud";
  file_ = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);  // not waiting for a carrier
  if (file_ < 0) return reasonOf(errno);
  if (!makeRaw(file_, speed->second)) {
    const std::string reason = isatty(file_) ? reasonOf(errno) : "not a serial port";
    close();
    return reason;
  }
  ioctl(file_, TIOCEXCL);
  askForLowLatency(file_);
  return "";
}

void SerialPort::close() {
  if (file_ < 0) return;
  tcflush(file_, TCIOFLUSH);  // close() may wait half a minute for what is not sent
  ::close(file_);
  file_ = -1;
}

void SerialPort::lose(const std::string& reason) {
  close();
  loss_reason_ = reason;
}

std::size_t SerialPort::read(std::uint8_t* bytes, std::size_t capacity, double timeout_s) {
  if (!isOpen()) return 0;
  pollfd watched{file_, POLLIN, 0};
  const int ready = poll(&watched, 1, static_cast<int>(std::ceil(1e3 * timeout_s)));
  if (ready < 0 && !isPassing(errno)) lose(reasonOf(errno));
  if (ready <= 0) return 0;
  const ssize_t size = ::read(file_, bytes, capacity);  // also at a hang-up: what came before it counts
  if (size > 0) return static_cast<std::size_t>(size);
  if (size < 0 && !isPassing(errno)) {
    lose(reasonOf(errno));
  } else if (watched.revents & (POLLHUP | POLLERR | POLLNVAL) || size == 0) {
    lose("hung up");
  }
  return 0;
}

void SerialPort::write(const std::string& text) {
  if (!isOpen()) return;
  const ssize_t written = ::write(file_, text.data(), text.size());
  if (written < 0 && !isPassing(errno)) lose(reasonOf(errno));
}

}  // namespace flight_corridor::serial
