#include "ros/range_serial_params.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "serial/serial_port.hpp"

namespace flight_corridor_ros {

namespace {

namespace serial = flight_corridor::serial;
using flight_corridor::above;
using flight_corridor::from;
using flight_corridor::Rule;
using flight_corridor::Violations;

constexpr double kMostRequests_hz = 100.0;

std::string protocolNames() {
  std::string names;
  for (const auto protocol : serial::kProtocols) {
    names += (names.empty() ? "one of " : ", ") + std::string(toString(protocol));
  }
  return names;
}

std::string baudNames() {
  std::string names;
  for (const int rate : serial::baudRates()) names += (names.empty() ? "one of " : ", ") + std::to_string(rate);
  return names;
}

/// The protocol named by the values; without one the first, and the broken rules.
serial::Protocol protocolIn(const Values& values, Violations& broken) {
  const auto found = values.find("protocol");
  if (found == values.end()) {
    broken.push_back("protocol: missing; " + protocolNames());
    return serial::kProtocols.front();
  }
  const auto* name = std::get_if<std::string>(&found->second);
  const auto protocol = name ? serial::parseProtocol(*name) : std::nullopt;
  if (!protocol) broken.push_back("protocol: " + protocolNames() + " (" + describe(found->second) + ")");
  return protocol.value_or(serial::kProtocols.front());
}

std::string unitNames(serial::Protocol protocol) {
  std::string names;
  for (const std::string& unit : unitsOf(protocol)) names += (names.empty() ? "" : " or ") + unit;
  return names + ", as protocol " + toString(protocol) + " has it";
}

/// One byte as 0x5A.
std::optional<char> parseByte(const std::string& word) {
  const bool is_hexadecimal = word.size() >= 3 && word.size() <= 4 && word.compare(0, 2, "0x") == 0 &&
                              word.find_first_not_of("0123456789abcdefABCDEF", 2) == std::string::npos;
  if (!is_hexadecimal) return std::nullopt;
  return static_cast<char>(std::stoul(word, nullptr, 16));
}

/// Words that begin with 0x are bytes; any other text is sent as it is, its \r and \n as those characters.
/// @return nullopt if a word is not a byte.
std::optional<std::string> parseWake(const std::string& text) {
  std::string bytes;
  if (text.compare(0, 2, "0x") == 0) {
    std::istringstream words(text);
    for (std::string word; words >> word;) {
      const auto byte = parseByte(word);
      if (!byte) return std::nullopt;
      bytes.push_back(*byte);
    }
    return bytes;
  }
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char next = text[i] == '\\' && i + 1 < text.size() ? text[i + 1] : '\0';
    const bool is_escape = next == 'r' || next == 'n';
    bytes.push_back(!is_escape ? text[i] : next == 'r' ? '\r' : '\n');
    i += is_escape;
  }
  return bytes;
}

flight_corridor::Parameters parametersOf(RangeSerialConfig& c) {
  const auto& rates = serial::baudRates();
  const auto units = unitsOf(c.protocol);
  const std::string protocol = "0: protocol " + std::string(toString(c.protocol));
  const bool is_frame = !c.frame_id.empty() && c.frame_id.front() != '/';
  const double nearest_m = c.limits.min_range_m, strength = c.limits.strength_min;
  return {{"port", &c.port, Rule().where(!c.port.empty(), "a device, e.g. /dev/ttyUSB0")},
          {"baud", &c.baud, Rule().where(std::count(rates.begin(), rates.end(), c.baud) > 0, baudNames())},
          {"frame_id", &c.frame_id, Rule().where(is_frame, "a frame's name without a leading slash")},
          {"field_of_view_rad", &c.field_of_view_rad, above(0).below(1)},
          {"min_range_m", &c.limits.min_range_m,
           Rule().where(0.0 <= nearest_m && nearest_m < c.limits.max_range_m, "0 or more, below max_range_m")},
          {"max_range_m", &c.limits.max_range_m, Rule().where(c.limits.max_range_m <= 1000.0, "up to 1000")},
          {"strength_min", &c.limits.strength_min,
           Rule()
               .where(0.0 <= strength && std::isfinite(strength), "0 or more, finite")
               .where(hasStrength(c.protocol) || strength == 0.0, protocol + " reports no strength")},
          {"unit", &c.unit, Rule().where(std::count(units.begin(), units.end(), c.unit) > 0, unitNames(c.protocol))},
          {"wake", &c.wake, Rule().where(parseWake(c.wake).has_value(), "bytes, each from 0x00 to 0xFF, or a text")},
          {"request_hz", &c.request_hz,
           from(0)
               .upTo(kMostRequests_hz)
               .where(!requestOf(c.protocol).empty() || c.request_hz == 0.0, protocol + " cannot be polled")},
          {"silence_s", &c.silence_s, from(0.1).upTo(3600)}};
}

}  // namespace

RangeSerialConfig makeRangeSerialConfig(const Values& values) {
  Violations broken;
  RangeSerialConfig config;
  config.protocol = protocolIn(values, broken);
  const serial::SensorDefaults defaults = defaultsOf(config.protocol);
  config.field_of_view_rad = defaults.field_of_view_rad;
  config.limits = {defaults.min_range_m, defaults.max_range_m, defaults.strength_min};
  config.unit = unitsOf(config.protocol).front();
  Values others = values;
  others.erase("protocol");
  const Violations others_broken = flight_corridor::assign(others, [&config] { return parametersOf(config); });
  broken.insert(broken.end(), others_broken.begin(), others_broken.end());
  flight_corridor::throwIfBroken(broken);
  config.wake = parseWake(config.wake).value();
  return config;
}

}  // namespace flight_corridor_ros
