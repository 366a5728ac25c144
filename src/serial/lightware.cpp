#include "serial/lightware.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>

namespace flight_corridor::serial {

namespace {

constexpr std::size_t kMostWholeDigits = 3;
constexpr std::size_t kDecimals = 2;  // as all their manuals show; fewer: bytes were lost
constexpr double kNothingReturned = -1.0;

bool isDigit(char character) { return '0' <= character && character <= '9'; }

bool areDigits(std::string_view text) { return std::all_of(text.begin(), text.end(), isDigit); }

bool removePrefix(std::string_view& text, std::string_view prefix) {
  if (text.substr(0, prefix.size()) != prefix) return false;
  text.remove_prefix(prefix.size());
  return true;
}

/// The name of the value in an answer or a stream.
void removeLabel(std::string_view& text) {
  if (removePrefix(text, "?LD ")) return;
  std::string_view rest = text;
  if (!removePrefix(rest, "ld,") || rest.size() < 2 || !isDigit(rest[0]) || rest[1] != ':') return;
  text = rest.substr(2);
}

void removeUnit(std::string_view& text) {
  if (text.empty() || text.back() != 'm') return;
  text.remove_suffix(1);
  if (!text.empty() && text.back() == ' ') text.remove_suffix(1);
}

/// Up to three digits, a point, two digits.
std::optional<double> parseMetres(std::string_view text) {
  const std::size_t point = text.find('.');
  if (point == std::string_view::npos || point == 0 || point > kMostWholeDigits) return std::nullopt;
  const std::string_view whole = text.substr(0, point), decimals = text.substr(point + 1);
  if (decimals.size() != kDecimals || !areDigits(whole) || !areDigits(decimals)) return std::nullopt;
  return std::stoi(std::string(whole) + std::string(decimals)) / 100.0;
}

/// The text after a minus: up to three digits, with or without decimals.
std::optional<double> parseCode(std::string_view text) {
  const std::size_t point = std::min(text.find('.'), text.size());
  const std::string_view whole = text.substr(0, point), decimals = text.substr(std::min(point + 1, text.size()));
  if (whole.empty() || whole.size() > kMostWholeDigits || decimals.size() > kMostWholeDigits) return std::nullopt;
  if (!areDigits(whole) || !areDigits(decimals)) return std::nullopt;
  return -std::stod(std::string(whole) + "." + std::string(decimals) + "0");
}

Parsed readCode(std::string_view text) {
  const std::optional<double> code = parseCode(text);
  if (!code) return {};
  Parsed parsed{Parsed::Outcome::Valid, {}};
  if (*code == kNothingReturned) {
    parsed.measurement.range_m = std::numeric_limits<double>::infinity();
  } else {
    parsed.measurement.error_code = *code;
  }
  return parsed;
}

}  // namespace

Parsed parseLightware(std::string_view line) {
  removeLabel(line);
  removeUnit(line);
  if (removePrefix(line, "-")) return readCode(line);
  const std::optional<double> metres = parseMetres(line);
  if (!metres) return {};
  Parsed parsed{Parsed::Outcome::Valid, {}};
  parsed.measurement.range_m = *metres;
  return parsed;
}

}  // namespace flight_corridor::serial
