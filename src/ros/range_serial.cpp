#include "ros/range_serial.hpp"

#include <ros/console.h>
#include <ros/node_handle.h>
#include <sensor_msgs/Range.h>

#include <algorithm>
#include <cmath>

namespace flight_corridor_ros {

namespace {

namespace serial = flight_corridor::serial;

constexpr double kStep_s = 0.05;        // longest wait of a shutdown
constexpr double kOpening_s = 0.5;      // between attempts
constexpr double kBits = 10.0;          // of a byte: 8N1
constexpr std::uint32_t kQueue = 1000;  // readings: 1 s at 1 kHz

/// By a steady clock.
double steadySeconds() { return ros::SteadyTime::now().toSec(); }

/// Before /clock ticks there is no time.
ros::Time toStamp(double stamp_s) { return stamp_s > 0.0 ? ros::Time(stamp_s) : ros::Time(); }

}  // namespace

RangeSerial::RangeSerial(const ros::NodeHandle& node, const ros::NodeHandle& private_node)
    : config_(makeRangeSerialConfig(readParameters(private_node))),
      parser_(config_.protocol, config_.limits, kBits / config_.baud, flight_corridor::serial::metresOf(config_.unit)),
      next_opening_s_(steadySeconds()),
      next_request_s_(next_opening_s_),
      wake_s_(next_opening_s_),
      heard_s_(next_opening_s_),
      valid_s_(next_opening_s_),
      diagnostics_(node, private_node, config_.port),
      publisher_(ros::NodeHandle(node).advertise<sensor_msgs::Range>("range", kQueue)) {}

void RangeSerial::step() {
  if (port_.isOpen()) {
    receive(port_.read(bytes_.data(), bytes_.size(), waitSeconds()));
    requestWhenDue();
    wakeInSilence();
    noticeLoss();
  } else {
    openWhenDue();
    if (!port_.isOpen()) ros::WallDuration(kStep_s).sleep();
  }
  warnOfSilence();
}

void RangeSerial::openWhenDue() {
  const double now_s = steadySeconds();
  if (now_s < next_opening_s_) return;
  next_opening_s_ = now_s + kOpening_s;
  trouble_ = port_.open(config_.port, config_.baud);
  diagnostics_.recordPort(trouble_);
  if (!trouble_.empty()) return;
  parser_.restart();
  wake();
  noticeLoss();
  if (!port_.isOpen() || !opening_info_.due()) return;
  ROS_INFO("%s is open: %s, %d baud", config_.port.c_str(), toString(config_.protocol), config_.baud);
}

void RangeSerial::receive(std::size_t size) {
  if (size == 0) return;
  readings_.clear();
  parser_.feed(bytes_.data(), size, ros::Time::now().toSec(), readings_);
  diagnostics_.recordCounts(parser_.counts());
  for (const serial::WireReading& reading : readings_) publish(reading);
  if (readings_.empty()) return;
  warnOfInvalidRanges();
  heard_s_ = steadySeconds();
  heard_bytes_ = parser_.counts().bytes;
}

void RangeSerial::publish(const serial::WireReading& reading) {
  sensor_msgs::Range message;
  message.header.stamp = toStamp(reading.stamp_s);
  message.header.frame_id = config_.frame_id;
  message.radiation_type = sensor_msgs::Range::INFRARED;
  message.field_of_view = static_cast<float>(config_.field_of_view_rad);
  message.min_range = static_cast<float>(config_.limits.min_range_m);
  message.max_range = static_cast<float>(config_.limits.max_range_m);
  message.range = static_cast<float>(reading.range_m);
  publisher_.publish(message);
  diagnostics_.recordReading(reading);
}

/// Up to the next request.
double RangeSerial::waitSeconds() const {
  if (config_.request_hz == 0.0) return kStep_s;
  return std::clamp(next_request_s_ - steadySeconds(), 0.0, kStep_s);
}

void RangeSerial::requestWhenDue() {
  const double now_s = steadySeconds();
  if (config_.request_hz == 0.0 || now_s < next_request_s_) return;
  next_request_s_ = std::max(next_request_s_ + 1.0 / config_.request_hz, now_s);
  port_.write(requestOf(config_.protocol));
}

void RangeSerial::wake() {
  wake_s_ = steadySeconds();
  if (!config_.wake.empty()) port_.write(config_.wake);
}

/// The sensor may start later than the port opens.
void RangeSerial::wakeInSilence() {
  if (steadySeconds() - std::max(heard_s_, wake_s_) > config_.silence_s) wake();
}

void RangeSerial::noticeLoss() {
  if (port_.isOpen()) return;
  trouble_ = port_.lossReason();
  diagnostics_.recordPort(trouble_);
  if (!loss_warning_.due()) return;
  ROS_WARN("%s is gone: %s. Trying again every %.1f s", config_.port.c_str(), trouble_.c_str(), kOpening_s);
}

void RangeSerial::warnOfSilence() {
  const double silent_s = steadySeconds() - heard_s_;
  if (silent_s <= config_.silence_s || !silence_warning_.due()) return;
  ROS_WARN("no reading from %s for %.1f s (silence_s: %.1f): %s", config_.port.c_str(), silent_s, config_.silence_s,
           silenceCause().c_str());
}

/// The observed cause, and the remedy.
std::string RangeSerial::silenceCause() const {
  if (!trouble_.empty()) return trouble_ + ". Check the plug, the name in /dev, and that the user is in group dialout";
  const std::uint64_t bytes = parser_.counts().bytes - heard_bytes_;
  if (bytes > 0) {
    return std::to_string(bytes) + " bytes came, but no reading; " + std::to_string(parser_.counts().checksum_errors) +
           " wrong checksums so far. Check protocol (" + toString(config_.protocol) + ") and baud (" +
           std::to_string(config_.baud) + ")";
  }
  const bool may_wait = !requestOf(config_.protocol).empty() && config_.request_hz == 0.0;
  return std::string("no byte came. Check power and wiring (its TX to our RX)") +
         (may_wait ? ", and set request_hz if the sensor sends on demand" : "");
}

/// Says that for a while no reading was a range, nor "nothing in range".
void RangeSerial::warnOfInvalidRanges() {
  const double now_s = steadySeconds();
  const bool is_valid =
      std::any_of(readings_.begin(), readings_.end(), [](const auto& reading) { return !std::isnan(reading.range_m); });
  if (is_valid || now_s - heard_s_ > config_.silence_s) valid_s_ = now_s;
  const double invalid_s = now_s - valid_s_;
  const bool is_invalid = invalid_s > config_.silence_s;
  const std::string cause = is_invalid ? invalidCause(readings_.back()) : "";
  diagnostics_.recordInvalid(cause);
  if (!is_invalid || !invalid_warning_.due()) return;
  ROS_WARN("no reading from %s had a range for %.1f s (silence_s: %.1f): %s", config_.port.c_str(), invalid_s,
           config_.silence_s, cause.c_str());
}

/// What a reading without a range says, and the remedy.
std::string RangeSerial::invalidCause(const serial::WireReading& reading) const {
  const auto written = [](double value) { return std::to_string(std::lround(value)); };
  if (!std::isnan(reading.error_code)) {
    const std::string error = reading.error;
    return "the sensor sends error code " + written(reading.error_code) + " in place of a distance" +
           (error.empty() ? ". See its manual and its lens; it may hang: switch it off and on" : ": " + error);
  }
  if (std::isnan(reading.strength)) {
    return "the sensor does not answer the Arduino. Check its power and wiring; it may hang: switch it off and on";
  }
  if (reading.strength >= config_.limits.strength_min) {
    return "the return is overexposed, strength " + written(reading.strength) + ". There is something bright before it";
  }
  const std::string text = "strength " + written(reading.strength) + " is below strength_min (" +
                           written(config_.limits.strength_min) + "). ";
  return text + (reading.strength == 0.0 ? "A sensor that sends no strength, like Benewake's TF03, needs strength_min "
                                           "0; another one may hang: switch it off and on"
                                         : "Perhaps nothing returns, or the lens is dirty; else lower strength_min");
}

}  // namespace flight_corridor_ros
