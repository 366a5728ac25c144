#include "flight_corridor/corridor/verdict.hpp"

#include <cmath>

namespace flight_corridor {

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
  static const char* const kNames[] = {
      "OCCUPIED_CELL",    "SHORT_RANGE",  "UNOBSERVED",   "NO_DATA",  "NO_POSE",        "BAD_IMAGE",
      "BAD_CALIBRATION",  "NO_DISPARITY", "DISAGREEMENT", "NO_LIDAR", "LIDAR_REJECTED", "NO_RANGE_OBSERVED",
      "RECENTLY_BLOCKED", "FROZEN_IMAGE", "AMBIGUOUS",    "WEAK_EVIDENCE",  "LIDAR_NEARER"};
  std::string text;
  std::uint32_t bit = 1;
  for (const char* name : kNames) {
    if (reasons & bit) text += (text.empty() ? "" : "|") + std::string(name);
    bit <<= 1;
  }
  return text;
}

std::uint32_t reasonsOf(const CorridorOccupancy& occupancy, double max_unknown_fraction) {
  std::uint32_t reasons = 0;
  if (std::isfinite(occupancy.clear_distance_m)) reasons |= kOccupiedCell;
  if (!(occupancy.unknown_fraction <= max_unknown_fraction)) reasons |= kUnobserved;
  return reasons;
}

std::uint32_t reasonsOf(const TrackedRange& tracked) {
  std::uint32_t reasons = 0;
  if (tracked.range.dissent) reasons |= kDisagreement;
  if (tracked.lidar_is_nearer) reasons |= kDisagreement | kLidarNearer;
  if (std::isnan(tracked.range_lidar_m) || tracked.lidar_is_slow) reasons |= kNoLidar;
  if (tracked.lidar_is_rejected) reasons |= kLidarRejected;
  if (std::isnan(tracked.range.range_m)) reasons |= kNoRangeObserved;
  return reasons;
}

}  // namespace flight_corridor
