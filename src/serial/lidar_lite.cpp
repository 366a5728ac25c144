#include "serial/lidar_lite.hpp"

#include <charconv>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>

namespace flight_corridor::serial {

namespace {

constexpr std::size_t kChecksumDigits = 2;
constexpr double kCentimetres_m = 0.01;

/// The whole text as an unsigned number of this type.
template <typename Number>
std::optional<Number> parseNumber(std::string_view text, int base = 10) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number, base);
  if (error != std::errc() || stop != end) return std::nullopt;
  return number;
}

std::uint8_t checksum(std::string_view text) {
  return std::accumulate(text.begin(), text.end(), std::uint8_t{0},
                         [](std::uint8_t sum, char c) { return static_cast<std::uint8_t>(sum ^ c); });
}

/// The content of "R,<cm>,<strength>".
std::optional<Measurement> parseBody(std::string_view body) {
  if (body == "E") return Measurement();
  if (body.substr(0, 2) != "R,") return std::nullopt;
  body.remove_prefix(2);
  const std::size_t comma = body.find(',');
  if (comma == std::string_view::npos) return std::nullopt;
  const auto strength = parseNumber<std::uint8_t>(body.substr(comma + 1));
  if (!strength) return std::nullopt;
  const double strength_value = *strength;
  if (comma == 0) return Measurement{std::numeric_limits<double>::infinity(), strength_value};
  const auto range_cm = parseNumber<std::uint16_t>(body.substr(0, comma));
  if (!range_cm) return std::nullopt;
  return Measurement{kCentimetres_m * *range_cm, strength_value};
}

}  // namespace

Parsed parseLidarLite(std::string_view line) {
  const std::size_t star = line.rfind('*');
  if (star == std::string_view::npos || line.size() - star - 1 != kChecksumDigits) return {};
  const auto announced = parseNumber<std::uint8_t>(line.substr(star + 1), 16);
  if (!announced) return {};
  const std::string_view body = line.substr(0, star);
  if (*announced != checksum(body)) return {Parsed::Outcome::WrongChecksum, {}};
  const std::optional<Measurement> measurement = parseBody(body);
  return measurement ? Parsed{Parsed::Outcome::Valid, *measurement} : Parsed{};
}

}  // namespace flight_corridor::serial
