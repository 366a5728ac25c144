#include "ros/range_serial_params.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "ros/fields.hpp"
#include "serial/serial_port.hpp"

namespace flight_corridor_ros {

namespace {

namespace serial = flight_corridor::serial;
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

/// Also refuses NaN: each rule states the accepted values.
Violations check(const RangeSerialConfig& c) {
  Violations broken;
  const auto require = [&broken](bool holds, const std::string& key, const std::string& rule, const Value& value) {
    if (!holds) broken.push_back(key + ": " + rule + " (" + describe(value) + ")");
  };
  const auto& rates = serial::baudRates();
  const auto units = unitsOf(c.protocol);
  require(!c.port.empty(), "port", "a device, e.g. /dev/ttyUSB0", c.port);
  require(std::find(rates.begin(), rates.end(), c.baud) != rates.end(), "baud", baudNames(), c.baud);
  require(!c.frame_id.empty() && c.frame_id.front() != '/', "frame_id", "a frame's name without a leading slash",
          c.frame_id);
  require(0.0 < c.field_of_view_rad && c.field_of_view_rad < 1.0, "field_of_view_rad", "above 0, below 1",
          c.field_of_view_rad);
  require(0.0 <= c.limits.min_range_m && c.limits.min_range_m < c.limits.max_range_m, "min_range_m",
          "0 or more, below max_range_m", c.limits.min_range_m);
  require(c.limits.max_range_m <= 1000.0, "max_range_m", "up to 1000", c.limits.max_range_m);
  require(0.0 <= c.limits.strength_min && std::isfinite(c.limits.strength_min), "strength_min", "0 or more, finite",
          c.limits.strength_min);
  require(hasStrength(c.protocol) || c.limits.strength_min == 0.0, "strength_min",
          "0: protocol " + std::string(toString(c.protocol)) + " reports no strength", c.limits.strength_min);
  require(std::count(units.begin(), units.end(), c.unit) > 0, "unit", unitNames(c.protocol), c.unit);
  require(parseWake(c.wake).has_value(), "wake", "bytes, each from 0x00 to 0xFF, or a text", c.wake);
  require(0.0 <= c.request_hz && c.request_hz <= kMostRequests_hz, "request_hz", "0 to 100", c.request_hz);
  require(!requestOf(c.protocol).empty() || c.request_hz == 0.0, "request_hz",
          "0: protocol " + std::string(toString(c.protocol)) + " cannot be polled", c.request_hz);
  require(0.1 <= c.silence_s && c.silence_s <= 3600.0, "silence_s", "0.1 to 3600", c.silence_s);
  return broken;
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
  const Fields fields{{"port", &config.port},
                      {"baud", &config.baud},
                      {"frame_id", &config.frame_id},
                      {"field_of_view_rad", &config.field_of_view_rad},
                      {"min_range_m", &config.limits.min_range_m},
                      {"max_range_m", &config.limits.max_range_m},
                      {"strength_min", &config.limits.strength_min},
                      {"unit", &config.unit},
                      {"wake", &config.wake},
                      {"request_hz", &config.request_hz},
                      {"silence_s", &config.silence_s}};
  const Violations unassigned = assign(others, fields);
  for (const Violations& part : {unassigned, check(config)}) broken.insert(broken.end(), part.begin(), part.end());
  flight_corridor::throwIfBroken(broken);
  config.wake = parseWake(config.wake).value();
  return config;
}

}  // namespace flight_corridor_ros
