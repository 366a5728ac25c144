#include "ros/stamp_age.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace flight_corridor_ros {

namespace {

constexpr double kHour_s = 3600.0, kZone_s = 1800.0;
constexpr double kLong_s = 900.0;    // from here on hours are said, too
constexpr double kNearZone_s = 5.0;  // what clocks that nobody synchronises differ by besides

}  // namespace

std::string describeAge(double age_s) {
  std::array<char, 96> text;
  std::snprintf(text.data(), text.size(), "%.3f s", std::abs(age_s));
  std::string seconds = text.data();
  if (std::abs(age_s) >= kLong_s) {
    std::snprintf(text.data(), text.size(), " (%.1f h)", std::abs(age_s) / kHour_s);
    seconds += text.data();
  }
  return age_s < 0.0 ? "stamped " + seconds + " ahead of the clock" : seconds + " old";
}

std::string clockRemedy(double age_s) {
  std::string text = "synchronise the clocks of this computer and of the sender (chrony, NTP, PTP)";
  const double zones = std::round(std::abs(age_s) / kZone_s);
  const bool is_zone = 1.0 <= zones && zones <= 28.0 && std::abs(std::abs(age_s) - zones * kZone_s) <= kNearZone_s;
  if (is_zone) text += "; a multiple of half an hour: does one of them use local time as UTC?";
  return text;
}

}  // namespace flight_corridor_ros
