#include "flight_corridor/types.hpp"

#include <sstream>
#include <stdexcept>

namespace flight_corridor {

void throwIfBroken(const Violations& broken, const std::string& title) {
  if (broken.empty()) return;
  std::string text = title + ":";
  for (const std::string& violation : broken) text += "\n  " + violation;
  throw std::invalid_argument(text);
}

void Rules::require(bool holds, const std::string& key, const std::string& rule, double value) {
  std::ostringstream text;
  text << value;
  require(holds, key, rule, text.str());
}

void Rules::require(bool holds, const std::string& key, const std::string& rule, const std::string& value) {
  if (!holds) broken_.push_back(section_ + "/" + key + ": " + rule + " (" + value + ")");
}

const char* toString(State state) {
  switch (state) {
    case State::Free:
      return "FREE";
    case State::Blocked:
      return "BLOCKED";
    case State::Unknown:
      break;
  }
  return "UNKNOWN";
}

State stateOf(std::uint32_t reasons) {
  constexpr std::uint32_t kInformation = kDisagreement | kNoLidar | kLidarRejected | kNoRangeObserved;
  if (reasons & (kOccupiedCell | kShortRange)) return State::Blocked;
  return reasons & ~kInformation ? State::Unknown : State::Free;
}

std::string describeReasons(std::uint32_t reasons) {
  static const char* const kNames[] = {"OCCUPIED_CELL",    "SHORT_RANGE",  "UNOBSERVED",      "NO_DATA",
                                       "NO_POSE",          "BAD_IMAGE",    "BAD_CALIBRATION", "NO_DISPARITY",
                                       "DISAGREEMENT",     "NO_LIDAR",     "LIDAR_REJECTED",  "NO_RANGE_OBSERVED",
                                       "RECENTLY_BLOCKED", "FROZEN_IMAGE", "UNMATCHED",       "OUTLINE"};
  std::string text;
  std::uint32_t bit = 1;
  for (const char* name : kNames) {
    if (reasons & bit) text += (text.empty() ? "" : "|") + std::string(name);
    bit <<= 1;
  }
  return text;
}

}  // namespace flight_corridor
