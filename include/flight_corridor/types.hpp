#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <string>
#include <utility>
#include <vector>

namespace flight_corridor {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Broken configuration rules as sentences "section/key: rule (value)"; empty when all hold.
using Violations = std::vector<std::string>;

/// @throws std::invalid_argument with the title and all of them, one a line, unless empty.
void throwIfBroken(const Violations& broken, const std::string& title = "broken configuration");

/// Collects the broken rules of one section of the configuration.
class Rules {
 public:
  explicit Rules(std::string section) : section_(std::move(section)) {}
  void require(bool holds, const std::string& key, const std::string& rule, double value);
  void require(bool holds, const std::string& key, const std::string& rule, const std::string& value);
  const Violations& broken() const { return broken_; }

 private:
  std::string section_;
  Violations broken_;
};

/// One rectified stereo pair. The images are shared, not copied.
struct StereoFrame {
  double stamp_s = kNaN;
  cv::Mat left;   ///< CV_8UC1, rectified, size of the calibration.
  cv::Mat right;  ///< CV_8UC1, rectified, same size and rows as left.
};

/// One reading of the one-dimensional LiDAR, as the driver gave it.
struct RangeReading {
  double stamp_s = kNaN;
  double range_m = kNaN;  ///< Along the beam. REP-117: -inf too close, +inf nothing in range, NaN erroneous.
  double min_range_m = 0.0;
  double max_range_m = kInfinity;
  double field_of_view_rad = 0.0;  ///< Full width of the beam's cone.
};

/// Convex region of space: the points p with planes^T (p, 1) >= 0; all of space without a plane. One plane a column:
/// unit normal pointing inwards, then offset [m]. T_A_B^T planes_A are the same planes in B (Hartley and Zisserman
/// 2004, ch. 3).
using ConvexRegion = Eigen::Matrix4Xd;

enum class State : std::uint8_t { Unknown = 0, Free = 1, Blocked = 2 };

/// "UNKNOWN", "FREE" or "BLOCKED".
const char* toString(State state);

/// Why the verdict is what it is: a bit set, the same numbers as in CorridorState.msg.
enum Reason : std::uint32_t {
  kOccupiedCell = 1u << 0,    ///< BLOCKED: an occupied cell intersects the box.
  kShortRange = 1u << 1,      ///< BLOCKED: the fused range ends inside the box, or may by one sigma.
  kUnobserved = 1u << 2,      ///< UNKNOWN: too much of the box has not been seen, or was not believed.
  kNoData = 1u << 3,          ///< UNKNOWN: no stereo pair, or the newest one is too old, or from before the last one.
  kNoPose = 1u << 4,          ///< UNKNOWN: a configured frame is not in tf at the pair's stamp, or its pose is none.
  kBadImage = 1u << 5,        ///< UNKNOWN: empty image, wrong size, unknown encoding, or left equal to right.
  kBadCalibration = 1u << 6,  ///< UNKNOWN: impossible or missing CameraInfo, or stereo that sees nothing before
                              ///< the corridor's last quarter.
  kNoDisparity = 1u << 7,     ///< UNKNOWN: hardly a pixel matched (no texture, saturated, covered lens).
  kDisagreement = 1u << 8,    ///< LiDAR and stereo disagree lastingly; the nearer one rules. UNKNOWN where that is the
                              ///< LiDAR and stereo does not show beside the beam what it met, or where it says that
                              ///< something is too close to be measured (-inf).
  kNoLidar = 1u << 9,  ///< Information: no usable LiDAR reading, or its rate fell below a third; stereo answers alone,
                       ///< or nearly so.
  kLidarRejected = 1u << 10,    ///< Information: the newest LiDAR reading was refused or gated.
  kNoRangeObserved = 1u << 11,  ///< Information: neither sensor gives a range on the beam.
  kRecentlyBlocked =
      1u << 12,             ///< UNKNOWN: nothing blocks now, but within corridor/hold_s something did that is not
                            ///< seen to have gone: thin, small, at the box's edge still, or not shown by the images.
  kFrozenImage = 1u << 13,  ///< UNKNOWN: an image equals one of the last eight under another stamp.
  kUnmatched = 1u << 14,    ///< UNKNOWN: a patch as large as the smallest obstacle is matched behind the box, but fits
                            ///< in it as well; or it may be a railing whose bars were taken for the wall behind.
  kOutline = 1u << 15,      ///< UNKNOWN: points in a cell of the box, too few for a hit: a bare thing's outline, or
                            ///< mistakes.
};

/// BLOCKED or UNKNOWN where a reason demands it (BLOCKED before UNKNOWN), otherwise FREE. Not of kDisagreement: that
/// takes knowing which sensor is the nearer one.
State stateOf(std::uint32_t reasons);

/// The reasons' names joined by '|', e.g. "OCCUPIED_CELL|SHORT_RANGE"; "" when none.
std::string describeReasons(std::uint32_t reasons);

/// The answer for one stereo pair.
struct Verdict {
  double stamp_s = kNaN;
  State state = State::Unknown;
  double clear_distance_m = kNaN;  ///< Along the box's axis to the nearest obstacle; +inf: none, NaN: not looked at.
  double unknown_fraction = 1.0;   ///< Unobserved share of the box's observable volume [0..1]; Corridor::inspect().
  std::uint32_t reasons = 0;       ///< Bit set of Reason.
};

}  // namespace flight_corridor
