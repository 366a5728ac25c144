#include "flight_corridor/corridor/verdict.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr double kWeakShare = 0.25;          // of the smallest obstacle's area: too much for chance
constexpr int kWeak_px = 12;                 // so are so many matches, though so near that they cover less
constexpr double kTooNear = 0.1;             // of the box
constexpr double kOutOfView = 0.25;          // of the box: beside the camera it is narrower than the box
constexpr double kEndOutOfView = 1.0 / 3.0;  // of the box's last quarter: the rest was seen from farther away

/// Too large for chance.
bool isWeak(const BoxPatch& patch, double smallest_m2) {
  return patch.in_box_px >= kWeak_px || patch.in_box_m2 > kWeakShare * smallest_m2;
}

/// Whether no more of a box is out of sight than may be.
bool isInSight(const Unobserved& unobserved) {
  return unobserved.too_near <= kTooNear && unobserved.out_of_view <= kOutOfView;
}

bool isEndInView(const Unobserved& unobserved) { return unobserved.end_out_of_view <= kEndOutOfView; }

}  // namespace

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
  constexpr std::uint32_t kInformation = kDisagreement | kNoLidar | kLidarRejected | kNoRangeObserved | kNoMotion;
  if (reasons & (kOccupiedCell | kShortRange | kMoving)) return State::Blocked;
  return reasons & ~kInformation ? State::Unknown : State::Free;
}

std::string describeReasons(std::uint32_t reasons) {
  static const char* const kNames[] = {"OCCUPIED_CELL",    "SHORT_RANGE",  "UNOBSERVED",      "NO_DATA",
                                       "NO_POSE",          "BAD_IMAGE",    "BAD_CALIBRATION", "NO_DISPARITY",
                                       "DISAGREEMENT",     "NO_LIDAR",     "LIDAR_REJECTED",  "NO_RANGE_OBSERVED",
                                       "RECENTLY_BLOCKED", "FROZEN_IMAGE", "AMBIGUOUS",       "WEAK_EVIDENCE",
                                       "LIDAR_NEARER",     "MOVING",       "NO_MOTION"};
  std::string text;
  std::uint32_t bit = 1;
  for (const char* name : kNames) {
    if (reasons & bit) text += (text.empty() ? "" : "|") + std::string(name);
    bit <<= 1;
  }
  return text;
}

void Verdict::block(Reason reason, double distance_m) {
  if (!std::isfinite(distance_m)) return;
  reasons |= reason;
  clear_distance_m = std::min(clear_distance_m, distance_m);
}

void Verdict::withhold(Reason reason) {
  reasons |= reason;
  state = stateOf(reasons);
  free_distance_m = 0.0;
}

void Verdict::limit(double moving_m) {
  if (moving_m == kInfinity) return;
  reasons |= kMoving;
  state = stateOf(reasons);
  free_distance_m = std::min(free_distance_m, moving_m);
}

std::uint32_t reasonsOf(const BoxEvidence& evidence, const CorridorConfig& config, double& clear_distance_m) {
  const double smallest_m2 = std::pow(smallestInspected(config), 2);
  std::uint32_t reasons = 0;
  clear_distance_m = kInfinity;
  for (const BoxPatch& patch : evidence.patches) {
    if (patch.blocks(smallest_m2)) {
      reasons |= kOccupiedCell;
      clear_distance_m = std::min(clear_distance_m, patch.begin_m);
    } else if (isWeak(patch, smallest_m2)) {
      reasons |= kWeakEvidence;
    }
  }
  if (reasons & kOccupiedCell) reasons &= ~kWeakEvidence;
  const Unobserved& unobserved = evidence.unobserved;
  const bool is_seen = !unobserved.hasHole() && unobserved.fraction <= config.max_unknown_fraction &&
                       isInSight(unobserved) && isEndInView(unobserved);
  if (!is_seen) reasons |= kUnobserved;
  if (evidence.is_ambiguous) reasons |= kAmbiguous;
  return reasons;
}

double freeDistance(const Verdict& verdict, const BoxEvidence& evidence, const CorridorConfig& config, const Box& box) {
  constexpr std::uint32_t kSaysWhere = kOccupiedCell | kShortRange | kUnobserved | kRecentlyBlocked | kWeakEvidence |
                                       kDisagreement | kNoLidar | kLidarRejected | kNoRangeObserved | kNoMotion;
  if (verdict.state == State::Free) return box.size_m.x();
  const Unobserved& unobserved = evidence.unobserved;
  const bool is_believed = (verdict.reasons & ~kSaysWhere) == 0 && isInSight(unobserved) && evidence.is_doubt_searched;
  if (!is_believed) return 0.0;
  double free_m =
      std::min({verdict.clear_distance_m, unobserved.hole_along_m, unobserved.unclear_along_m, box.size_m.x()});
  if (!isEndInView(unobserved)) free_m = std::min(free_m, (1.0 - kEndShare) * box.size_m.x());
  for (const BoxPatch& patch : evidence.patches) {
    if (isWeak(patch, std::pow(smallestInspected(config), 2))) free_m = std::min(free_m, patch.begin_m);
  }
  return free_m;
}

std::uint32_t reasonsOf(const TrackedRange& tracked) {
  std::uint32_t reasons = 0;
  if (tracked.range.disagreement) reasons |= kDisagreement;
  if (tracked.lidar_is_nearer) reasons |= kDisagreement | kLidarNearer;
  if (std::isnan(tracked.range_lidar_m) || tracked.lidar_is_slow) reasons |= kNoLidar;
  if (tracked.lidar_is_rejected) reasons |= kLidarRejected;
  if (std::isnan(tracked.range.range_m)) reasons |= kNoRangeObserved;
  return reasons;
}

}  // namespace flight_corridor
