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

/// Why the verdict is what it is: a bit set, the same numbers as in CorridorState.msg.
enum Reason : std::uint32_t {
  kOccupiedCell = 1u << 0,  ///< BLOCKED: a patch of matches, or a cell that the map remembers, is in the box.
  kShortRange = 1u << 1,    ///< BLOCKED: the fused range ends inside the box, or may by one sigma.
  kUnobserved = 1u << 2,  ///< UNKNOWN: somewhere in the box the smallest obstacle could stand unseen, or too much of it
                          ///< is out of view.
  kNoData = 1u << 3,      ///< UNKNOWN: no stereo pair, or the newest one is too old, or from before the last one.
  kNoPose = 1u << 4,      ///< UNKNOWN: a configured frame is not in tf at the pair's stamp, or its pose is invalid, or
                          ///< beyond the map's reach.
  kBadImage = 1u << 5,    ///< UNKNOWN: empty image, wrong size, unknown encoding, or left equal to right.
  kBadCalibration = 1u << 6,  ///< UNKNOWN: impossible or missing CameraInfo, or stereo that sees nothing before
                              ///< the corridor's last quarter.
  kNoDisparity = 1u << 7,     ///< UNKNOWN: hardly a pixel matched (no texture, saturated, covered lens).
  kDisagreement = 1u << 8,    ///< Information: LiDAR and stereo disagree persistently; the nearer one rules.
  kNoLidar = 1u << 9,  ///< Information: no usable LiDAR reading, or it pauses thrice as long as of late; stereo answers
                       ///< alone, or nearly so.
  kLidarRejected = 1u << 10,    ///< Information: the newest LiDAR reading was refused or gated.
  kNoRangeObserved = 1u << 11,  ///< Information: neither sensor gives a range on the beam.
  kRecentlyBlocked =
      1u << 12,              ///< UNKNOWN: nothing blocks now, but within corridor/hold_s something did that is not
                             ///< seen to have gone: thin, small, at the box's edge still, or not shown by the images.
  kFrozenImage = 1u << 13,   ///< UNKNOWN: an image equals one of the last eight under another stamp.
  kAmbiguous = 1u << 14,     ///< UNKNOWN: a patch as large as the smallest obstacle is matched behind the box, but fits
                             ///< in it as well; or it may be a railing whose bars were taken for the wall behind.
  kWeakEvidence = 1u << 15,  ///< UNKNOWN: a patch in the box, too small to block, too large for chance.
  kLidarNearer = 1u << 16,   ///< UNKNOWN: the LiDAR met something nearer than stereo sees, persistently or by more than
                             ///< the rig explains, and stereo shows nothing there beside the beam either; or it says
                             ///< that something is too close to be measured.
};

/// The rule: BLOCKED or UNKNOWN where a reason demands it (BLOCKED before UNKNOWN), otherwise FREE. One that nobody
/// knows demands UNKNOWN.
State stateOf(std::uint32_t reasons);

/// The reasons' names joined by '|', e.g. "OCCUPIED_CELL|SHORT_RANGE"; "" when none.
std::string describeReasons(std::uint32_t reasons);

/// The answer for one stereo pair.
struct Verdict {
  double stamp_s = kNaN;  ///< Of the pair that it rests on.
  State state = State::Unknown;
  double clear_distance_m = kNaN;  ///< Along the box's axis to the nearest obstacle; +inf: none, NaN: not looked at.
  double free_distance_m = 0.0;    ///< ... up to which the box is free from its start on; 0: not known.
  double unknown_fraction = 1.0;  ///< Share, of what both cameras see of the box, that no clear ray crosses; of a query
                                  ///< out of view, too [0..1].
  std::uint32_t reasons = 0;      ///< Bit set of Reason.

  /// @param distance_m to what blocks; +inf: nothing does.
  void block(Reason reason, double distance_m);
};

/// What a pair shows of a box.
/// @param clear_distance_m to what blocks; +inf: nothing does.
std::uint32_t reasonsOf(const BoxEvidence& evidence, const CorridorConfig& config, double& clear_distance_m);

/// How far a box is free from its start on: up to its end, to what blocks it, or to what may before that, in sight or
/// in a hole. 0 where the verdict is UNKNOWN, or would be if nothing blocked, for more than holes [m].
double freeDistance(const Verdict& verdict, const BoxEvidence& evidence, const CorridorConfig& config, const Box& box);

/// What the two sensors say of the beam.
std::uint32_t reasonsOf(const TrackedRange& tracked);

}  // namespace flight_corridor
