#include "flight_corridor/range/range_tracker.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr double kUnity = 0.9;             // of a footprint from which the scale is learnt
constexpr double kShown = 1.0 / 3.0;       // of the matches beside the beam: stereo shows the LiDAR's surface, too
constexpr double kRemembered_s = 1.0;      // of a contradiction, at most
constexpr double kSameMoment_s = 0.03;     // at 1 rad/s the beam turns by 2 degrees in this time
constexpr double kReferenceDepth_m = 4.0;  // where the scale is reported when the beam meets nothing

bool isFused(Outcome outcome) { return outcome == Outcome::Accepted || outcome == Outcome::Reinitialised; }

}  // namespace

bool isRange(const RangeReading& reading, const LidarConfig& config) {
  return std::max(reading.min_range_m, config.min_range_m) <= reading.range_m &&
         reading.range_m <= std::min(reading.max_range_m, config.max_range_m);
}

RangeTracker::RangeTracker(const LidarConfig& lidar, const FusionConfig& fusion, const ScaleConfig& scale,
                           const StereoGeometry& geometry, const std::optional<Eigen::Isometry3d>& T_C_L)
    : lidar_config_(lidar),
      fusion_config_(fusion),
      scale_config_(scale),
      geometry_(geometry),
      has_lidar_(T_C_L.has_value()),
      beam_(lidar, geometry, T_C_L.value_or(opticalFromForward()), fusion.disparity_sigma_px),
      fusion_(fusion),
      scale_(scale) {}

/// With another direction of the beam its range changes as with a change of the scene, and is followed alike: a
/// disagreement persists.
void RangeTracker::mount(const std::optional<Eigen::Isometry3d>& T_C_L) {
  beam_ =
      BeamFootprint(lidar_config_, geometry_, T_C_L.value_or(opticalFromForward()), fusion_config_.disparity_sigma_px);
  if (has_lidar_ != T_C_L.has_value()) {
    fusion_ = RangeFusion(fusion_config_);
    lidar_ = LidarWatch();
    ranges_.forget();
  }
  has_lidar_ = T_C_L.has_value();
}

/// Accelerations first: ranges need them to be predicted.
void RangeTracker::fuseReadings(double stamp_s) {
  for (const Acceleration& reading : accelerations_.take(stamp_s)) {
    fusion_.addAcceleration(reading.stamp_s, beam_.along(reading.acceleration_C_mps2));
  }
  for (const RangeReading& reading : ranges_.take(stamp_s)) fuse(reading);
  counts_.refused = ranges_.refused() + accelerations_.refused();
}

void RangeTracker::fuse(const RangeReading& reading) {
  Outcome outcome = Outcome::Invalid;
  if (has_lidar_ && isRange(reading, lidar_config_)) {
    outcome = fusion_.add(Sensor::Lidar, reading.stamp_s, reading.range_m, fusion_config_.lidar_variance_m2);
  }
  lidar_.add(reading, isFused(outcome));
  ++counts_.lidar;
  counts_.lidar_invalid += outcome == Outcome::Invalid || outcome == Outcome::TooLate;
  counts_.lidar_gated += outcome == Outcome::Gated;
}

TrackedRange RangeTracker::update(double stamp_s, const cv::Mat& disparity_px) {
  fuseReadings(stamp_s);
  TrackedRange tracked;
  scale_.forgetUntil(stamp_s);
  const RangeEstimate expected = fusion_.at(stamp_s);
  const auto stereo = beam_.read(disparity_px, expected.range_m, lidar_.beamWidth());
  double reference_px = geometry_.disparity(kReferenceDepth_m);
  if (stereo) {
    learnScale(stamp_s, *stereo, expected);
    reference_px = stereo->disparity_px;
    tracked.range_stereo_m = beam_.range(geometry_.depth(scale_.correct(stereo->disparity_px)));
    tracked.stereo_outcome = fusion_.add(Sensor::Stereo, stamp_s, tracked.range_stereo_m,
                                         stereoVariance(*stereo, expected), rigSigma(*stereo));
    counts_.stereo_gated += tracked.stereo_outcome == Outcome::Gated;
  }
  tracked.range = fusion_.at(stamp_s);
  tracked.range_lidar_m = lidarRange(stamp_s);
  judge(stamp_s, stereo, expected, disparity_px, tracked);
  tracked.scale = scale_.scale(reference_px);
  tracked.scale_sigma = scale_.sigma(reference_px);
  return tracked;
}

/// Judges the LiDAR's readings, and whether they contradict stereo.
/// @param expected before stereo's reading entered.
void RangeTracker::judge(double stamp_s, const std::optional<FootprintReading>& stereo, const RangeEstimate& expected,
                         const cv::Mat& disparity_px, TrackedRange& tracked) {
  const auto disagrees = [&](Sensor sensor) {
    return tracked.range.disagreement && tracked.range.disagreement->sensor == sensor;
  };
  tracked.lidar_is_slow = lidar_.isSlow(stamp_s);
  tracked.lidar_is_rejected = lidar_.isRejected();
  tracked.lidar_range_valid =
      lidar_.hasValidRange(stamp_s, fusion_config_.max_gap_s) && !tracked.lidar_is_slow && !disagrees(Sensor::Lidar);
  tracked.lidar_is_new =
      tracked.lidar_range_valid && lidar_.range(stamp_s, std::min(kSameMoment_s, stamp_s - pair_stamp_s_)) > 0.0;
  const bool too_close = has_lidar_ && lidar_.isTooClose(stamp_s, fusion_config_.max_gap_s);
  const double beyond_px = stereo ? beyondRig(stamp_s, *stereo, expected) : kNaN;
  const bool is_farther = disagrees(Sensor::Stereo) || beyond_px > 0.0;
  const bool contradicts = is_farther && !isShownBeside(expected.range_m, disparity_px);
  remember(stamp_s, contradicts, !is_farther && beyond_px == 0.0);
  tracked.lidar_is_nearer = too_close || contradicts || contradiction_s_ > 0.0;
}

/// By how much stereo's disparity misses the one that the LiDAR expects, beyond the errors of a correctable rig and of
/// the match [px]: positive if stereo is farther. NaN: the LiDAR has no reading.
double RangeTracker::beyondRig(double stamp_s, const FootprintReading& stereo, const RangeEstimate& expected) const {
  if (std::isnan(lidarRange(stamp_s))) return kNaN;
  return beyondRig(geometry_.disparity(beam_.depth(expected.range_m)), stereo.disparity_px);
}

double RangeTracker::beyondRig(double expected_px, double disparity_px) const {
  const double missing_px = expected_px - disparity_px;
  const double largest_px = scale_.largestError(disparity_px) + fusion_config_.disparity_sigma_px;
  return missing_px - std::clamp(missing_px, -largest_px, largest_px);
}

/// A contradiction holds until the two have agreed for as long as it lasted: in a wood the beam alternates between
/// surfaces, and a wrong rig seems right now and then.
void RangeTracker::remember(double stamp_s, bool contradicts, bool agrees) {
  const double since_s = std::isnan(pair_stamp_s_) ? 0.0 : std::min(stamp_s - pair_stamp_s_, kRemembered_s);
  pair_stamp_s_ = stamp_s;
  if (contradicts) contradiction_s_ = std::min(contradiction_s_ + since_s, kRemembered_s);
  if (agrees) contradiction_s_ = std::max(contradiction_s_ - since_s, 0.0);
  if (lidar_.isSilent(stamp_s, fusion_config_.max_gap_s)) contradiction_s_ = 0.0;
}

/// Whether the beam met an edge: stereo follows the surface behind it, but also shows the edge, and so does not
/// contradict the LiDAR.
bool RangeTracker::isShownBeside(double range_m, const cv::Mat& matched_px) {
  const double expected_px = geometry_.disparity(beam_.depth(range_m));
  const std::vector<float>& matches_px = beam_.matchesBeside(matched_px, range_m, lidar_.beamWidth());
  const auto shown = std::count_if(matches_px.begin(), matches_px.end(), [&](float d) {
    return beam_.isSameSurface(scale_.correct(d), expected_px) && beyondRig(expected_px, d) <= 0.0;
  });
  return shown > 0 && static_cast<double>(shown) >= kShown * static_cast<double>(matches_px.size());
}

/// R of D_c: the constant part, and the error of its disparity d by match and footprint. What differs from the expected
/// range Z' is compared with it in disparity: |Z - Z'| = Z Z'/(fB) |d - d'|. At its own depth alone, sigma_Z = Z^2/(fB)
/// sigma_d, a range that is far too large would agree with everything.
double RangeTracker::stereoVariance(const FootprintReading& stereo, const RangeEstimate& expected) const {
  const double depth_m = geometry_.depth(stereo.disparity_px), expected_m = beam_.depth(expected.range_m);
  const double sigma_px = std::hypot(fusion_config_.disparity_sigma_px, stereo.disparity_sigma_px);
  const double between_m = std::sqrt(depth_m * (expected_m > 0.0 ? expected_m : depth_m));
  return fusion_config_.stereo_variance_m2 + std::pow(geometry_.depthSigma(between_m, sigma_px), 2);
}

/// One sigma of the inverse range from the rig's uncertainty, the same in all readings: 1/Z = d/(fB) [1/m]. At most the
/// correctable error: a rig with a larger one is in disagreement.
double RangeTracker::rigSigma(const FootprintReading& stereo) const {
  if (!scale_config_.enabled) return 0.0;
  const double d = stereo.disparity_px;
  const double sigma_px = std::min(scale_.disparitySigma(d), scale_.largestError(d) / fusion_config_.gate_sigma);
  return sigma_px / geometry_.disparity(1.0);
}

/// The prediction without this pair's stereo is the reference. Without a LiDAR in it there is nothing to learn, and a
/// LiDAR that repeats itself may be frozen: the scale would follow it away from the truth.
void RangeTracker::learnScale(double stamp_s, const FootprintReading& stereo, const RangeEstimate& expected) {
  const bool has_reading = std::isfinite(lidarRange(stamp_s)) && !expected.lidar_repeats;
  if (!has_reading || !std::isfinite(expected.range_m)) return;
  if (stereo.unity < kUnity) return;  // among leaves LiDAR and stereo measure different surfaces
  const double depth_m = beam_.depth(expected.range_m);
  const double expected_px = geometry_.disparity(depth_m);
  const double expected_sigma_px = expected_px * expected.sigma_m / depth_m;
  const double measured_sigma_px = std::hypot(scale_config_.disparity_sigma_px, stereo.disparity_sigma_px);
  scale_.update(stamp_s, stereo.disparity_px, expected_px, measured_sigma_px, expected_sigma_px);
}

/// d_L for a frame: the newest reading that was fused, not older than fusion/max_gap_s; NaN without one.
double RangeTracker::lidarRange(double stamp_s) const { return lidar_.range(stamp_s, fusion_config_.max_gap_s); }

}  // namespace flight_corridor
