#pragma once

#include <cstdint>
#include <string>

#include "flight_corridor/corridor/box_inspector.hpp"
#include "flight_corridor/corridor/corridor.hpp"
#include "flight_corridor/range/range_tracker.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

enum class State : std::uint8_t { Unknown = 0, Free = 1, Blocked = 2 };

/// "UNKNOWN", "FREE" or "BLOCKED".
const char* toString(State state);

/// Reasons of a verdict: a bit set, with the numbers of CorridorState.msg.
enum Reason : std::uint32_t {
  kOccupiedCell = 1u << 0,  ///< BLOCKED: a patch of matches, or a cell that the map remembers, is in the box.
  kShortRange = 1u << 1,    ///< BLOCKED: the fused range ends inside the box, or may by one sigma.
  kUnobserved = 1u << 2,  ///< UNKNOWN: somewhere in the box the smallest obstacle could stand unseen, or too much of it
                          ///< is out of view.
  kNoData = 1u << 3,      ///< UNKNOWN: no stereo pair, or the newest one is too old, or from before the last one.
  kNoPose = 1u << 4,      ///< UNKNOWN: a configured frame is not in tf at the pair's stamp, or its pose is invalid, or
                          ///< beyond the map's reach.
  kBadImage = 1u << 5,    ///< UNKNOWN: empty image, wrong size, unknown encoding, or left equal to right.
  /// UNKNOWN: impossible or missing CameraInfo, or stereo sees nothing before the corridor's last quarter, or the rows
  /// of left and right image disagree, or the motion that is told contradicts that of the images.
  kBadCalibration = 1u << 6,
  kNoDisparity = 1u << 7,   ///< UNKNOWN: hardly any match (no texture, saturated, covered lens).
  kDisagreement = 1u << 8,  ///< Information: LiDAR and stereo disagree persistently; the nearer one rules.
  kNoLidar = 1u << 9,       ///< Information: no usable LiDAR reading, or it pauses three times its recent mean; stereo
                            ///< answers alone, or nearly so.
  kLidarRejected = 1u << 10,    ///< Information: the newest LiDAR reading was refused or gated.
  kNoRangeObserved = 1u << 11,  ///< Information: neither sensor gives a range on the beam.
  kRecentlyBlocked = 1u << 12,  ///< UNKNOWN: nothing blocks now, but within corridor/hold_s something did there that
                                ///< images may miss: thin, small, at a box's edge, or never shown.
  kFrozenImage = 1u << 13,      ///< UNKNOWN: an image equals one of the last eight, with another stamp.
  kAmbiguous = 1u << 14,     ///< UNKNOWN: a patch as large as the smallest obstacle is matched behind the box, but fits
                             ///< in it as well; or a railing's bars may be matched on the wall behind.
  kWeakEvidence = 1u << 15,  ///< UNKNOWN: a patch in the box, too small to block, too large for chance.
  /// UNKNOWN: the LiDAR measures less than stereo, persistently or by more than the rig explains, and stereo does not
  /// show it beside the beam; or it reports an obstacle too close to measure.
  kLidarNearer = 1u << 16,
  kMoving = 1u << 17,    ///< BLOCKED: something that moves can have come into the box before the UAV stands.
  kNoMotion = 1u << 18,  ///< Information: neither tf nor the images tell how the camera moved; earlier pairs are not
                         ///< asked.
};

/// The rule: BLOCKED or UNKNOWN if a reason demands it (BLOCKED before UNKNOWN), otherwise FREE. Unknown bits yield
/// UNKNOWN.
State stateOf(std::uint32_t reasons);

/// The reasons' names joined by '|', e.g. "OCCUPIED_CELL|SHORT_RANGE"; "" without any.
std::string describeReasons(std::uint32_t reasons);

/// The answer for one stereo pair.
struct Verdict {
  double stamp_s = kNaN;  ///< Of the pair that was judged.
  State state = State::Unknown;
  double clear_distance_m = kNaN;  ///< Along the box's axis to the nearest obstacle; +inf: none, NaN: not judged.
  double free_distance_m = 0.0;    ///< Up to which the box is free from its start on, in any state; 0: not known.
  double unknown_fraction = 1.0;  ///< Share without a clear ray of the volume in view of both cameras; for a query also
                                  ///< the share out of view [0..1].
  std::uint32_t reasons = 0;      ///< Bit set of Reason.

  /// @param distance_m to the obstacle; +inf: nothing blocks.
  void block(Reason reason, double distance_m);
  /// Adds a reason against FREE that does not say where: nothing is known to be free.
  void withhold(Reason reason);
  /// @param moving_m what moves lets the UAV fly so far; +inf: to the end.
  void limit(double moving_m);
};

/// Reasons from a pair's evidence about a box.
/// @param clear_distance_m to the obstacle; +inf: nothing blocks.
std::uint32_t reasonsOf(const BoxEvidence& evidence, const CorridorConfig& config, double& clear_distance_m);

/// How far a box is free from its start on [m]: up to its end, its obstacle, or before that a weak patch, a hole, too
/// much without a clear ray, or its last quarter if that is out of view. 0 if a reason against FREE has no place: a
/// faulty input, doubt or doubt not searched, too much out of view or too near.
double freeDistance(const Verdict& verdict, const BoxEvidence& evidence, const CorridorConfig& config, const Box& box);

/// Reasons from the two sensors on the beam.
std::uint32_t reasonsOf(const TrackedRange& tracked);

}  // namespace flight_corridor
