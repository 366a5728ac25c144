#include "flight_corridor/range/range_tracker.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr double kUnity = 0.9;             // of a footprint from which the scale is learnt
constexpr double kShown = 1.0 / 3.0;       // of the matches beside the beam: they show what the LiDAR met
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
      beam_(lidar, geometry, T_C_L.value_or(opticalFromForward())),
      fusion_(fusion),
      scale_(scale) {}

/// Where the beam points elsewhere, its range changes as it does where the scene changes, and is followed alike: what
/// disagreed before still does.
void RangeTracker::mount(const std::optional<Eigen::Isometry3d>& T_C_L) {
  beam_ = BeamFootprint(lidar_config_, geometry_, T_C_L.value_or(opticalFromForward()));
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
  const RangeEstimate expected = fusion_.at(stamp_s);
  const auto stereo = beam_.read(disparity_px, expected.range_m, lidar_.beamWidth());
  double reference_px = geometry_.disparity(kReferenceDepth_m);
  if (stereo) {
    learnScale(stamp_s, *stereo, expected);
    reference_px = stereo->disparity_px;
    tracked.range_stereo_m = beam_.range(geometry_.depth(scale_.correct(stereo->disparity_px)));
    tracked.stereo_outcome =
        fusion_.add(Sensor::Stereo, stamp_s, tracked.range_stereo_m, stereoVariance(*stereo), rigSigma(*stereo));
    counts_.stereo_gated += tracked.stereo_outcome == Outcome::Gated;
  }
  tracked.range = fusion_.at(stamp_s);
  tracked.range_lidar_m = lidarRange(stamp_s);
  const auto dissents = [&](Sensor sensor) { return tracked.range.dissent && tracked.range.dissent->sensor == sensor; };
  tracked.lidar_is_slow = lidar_.isSlow(stamp_s);
  tracked.lidar_is_rejected = lidar_.isRejected();
  tracked.lidar_range_valid =
      lidar_.hasValidRange(stamp_s, fusion_config_.max_gap_s) && !tracked.lidar_is_slow && !dissents(Sensor::Lidar);
  const bool too_close = has_lidar_ && lidar_.isTooClose(stamp_s, fusion_config_.max_gap_s);
  const bool is_contradicted = dissents(Sensor::Stereo) && !isShownBeside(tracked.range.range_m, disparity_px);
  tracked.lidar_is_nearer = is_contradicted || too_close;
  tracked.scale = scale_.scale(reference_px);
  tracked.scale_sigma = scale_.sigma(reference_px);
  return tracked;
}

/// Whether the beam met an edge: stereo follows what is behind it, but shows it, too, and does not contradict the
/// LiDAR.
bool RangeTracker::isShownBeside(double range_m, const cv::Mat& matched_px) {
  const double expected_px = geometry_.disparity(beam_.depth(range_m));
  const std::vector<float>& matches_px = beam_.matchesBeside(matched_px, range_m, lidar_.beamWidth());
  const auto shown = std::count_if(matches_px.begin(), matches_px.end(), [&](float d) {
    return std::abs(scale_.correct(d) - expected_px) <= BeamFootprint::kSameSurface_px;
  });
  return shown > 0 && static_cast<double>(shown) >= kShown * static_cast<double>(matches_px.size());
}

/// R of D_c: the constant part, and the match's and the footprint's spread in depth (sigma_Z = Z^2/(fB) sigma_d).
double RangeTracker::stereoVariance(const FootprintReading& stereo) const {
  const double depth_m = geometry_.depth(stereo.disparity_px);
  const double match_m = geometry_.depthSigma(depth_m, fusion_config_.disparity_sigma_px);
  const double spread_m = geometry_.depthSigma(depth_m, stereo.disparity_sigma_px);
  return fusion_config_.stereo_variance_m2 + match_m * match_m + spread_m * spread_m;
}

/// One sigma of the inverse range for what is unknown of the rig, the same in all readings: 1/Z = d/(fB) [1/m]. No more
/// than what the correction can make good: a rig that is further off is in disagreement.
double RangeTracker::rigSigma(const FootprintReading& stereo) const {
  if (!scale_config_.enabled) return 0.0;
  const double d = stereo.disparity_px;
  const double sigma_px = std::min(scale_.disparitySigma(d), scale_.largestError(d) / fusion_config_.gate_sigma);
  return sigma_px / geometry_.disparity(1.0);
}

/// The prediction that stereo has not entered yet is the reference; without a LiDAR in it there is nothing to learn,
/// and one that repeats itself may be frozen: the scale would follow it away from the truth.
void RangeTracker::learnScale(double stamp_s, const FootprintReading& stereo, const RangeEstimate& expected) {
  const bool has_reading = std::isfinite(lidarRange(stamp_s)) && !lidar_.repeatsItself();
  if (!has_reading || expected.dissent || !std::isfinite(expected.range_m)) return;
  if (stereo.unity < kUnity) return;  // among leaves LiDAR and stereo speak of different surfaces
  const double depth_m = beam_.depth(expected.range_m);
  const double expected_px = geometry_.disparity(depth_m);
  const double expected_sigma_px = expected_px * expected.sigma_m / depth_m;
  const double measured_sigma_px = std::hypot(scale_config_.disparity_sigma_px, stereo.disparity_sigma_px);
  scale_.update(stamp_s, stereo.disparity_px, expected_px, measured_sigma_px, expected_sigma_px);
}

/// d_L for a frame: the newest reading that was fused, not older than fusion/max_gap_s; NaN without one.
double RangeTracker::lidarRange(double stamp_s) const { return lidar_.range(stamp_s, fusion_config_.max_gap_s); }

}  // namespace flight_corridor
