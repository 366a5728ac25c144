#include "flight_corridor/pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/core.hpp>

namespace flight_corridor {

namespace {

constexpr double kFillSigma_px = 0.3;      // of a filtered disparity: at half size, not refined
constexpr double kUnity = 0.9;             // of a footprint from which the scale is learnt
constexpr double kReferenceDepth_m = 4.0;  // where the scale is told when the beam meets nothing
constexpr std::uint32_t kMapInDoubt =      // reasons of a frame that left no evidence in the map, or none to trust
    kNoData | kNoPose | kBadImage | kBadCalibration | kNoDisparity | kFrozenImage;

/// Adds the time until the end of its scope. Durations only: no result depends on a clock.
class Stopwatch {
 public:
  explicit Stopwatch(double& sum_ms) : sum_ms_(sum_ms) {}
  Stopwatch(const Stopwatch&) = delete;
  ~Stopwatch() { sum_ms_ += std::chrono::duration<double, std::milli>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  double& sum_ms_;
  Clock::time_point start_ = Clock::now();
};

bool isFused(Outcome outcome) { return outcome == Outcome::Accepted || outcome == Outcome::Reinitialised; }

const Config& valid(const Config& config) {
  throwIfBroken(check(config));
  return config;
}

}  // namespace

Pipeline::Pipeline(const Config& config, const StereoGeometry& geometry, const Rig& rig)
    : config_(valid(config)),
      geometry_(geometry),
      rig_(rig),
      disparity_estimator_(config.stereo, geometry),
      beam_(config.lidar, geometry, rig.T_C_L.value_or(opticalFromForward())),
      fusion_(config.fusion),
      scale_(config.scale),
      cloud_builder_(config.cloud, geometry),
      map_(config.map, geometry),
      corridor_(config.corridor) {
  if (config.map.frame_id.empty()) return;
  MapConfig forgetful = config.map;
  forgetful.frame_id.clear();
  frame_map_.emplace(forgetful, geometry);
}

Outcome Pipeline::addRange(const RangeReading& reading) {
  ++counters_.lidar_readings;
  Outcome outcome = Outcome::Invalid;
  const bool in_range = std::max(reading.min_range_m, config_.lidar.min_range_m) <= reading.range_m &&
                        reading.range_m <= std::min(reading.max_range_m, config_.lidar.max_range_m);
  if (rig_.T_C_L && in_range) {
    outcome = fusion_.add(Sensor::Lidar, reading.stamp_s, reading.range_m, config_.fusion.lidar_variance_m2);
  }
  counters_.lidar_invalid += outcome == Outcome::Invalid || outcome == Outcome::TooLate;
  counters_.lidar_gated += outcome == Outcome::Gated;
  lidar_.add(reading, isFused(outcome));
  return outcome;
}

void Pipeline::addAcceleration(double stamp_s, const Eigen::Vector3d& acceleration_C_mps2) {
  fusion_.addAcceleration(stamp_s, beam_.along(acceleration_C_mps2));
}

const Report& Pipeline::process(const StereoFrame& frame, const std::optional<Eigen::Isometry3d>& T_W_C) {
  report_ = Report();
  report_.verdict.stamp_s = frame.stamp_s;
  ++counters_.frames;
  if (const std::uint32_t reasons = faults(frame, T_W_C)) return refuse(reasons);
  const Stopwatch total(report_.times.total_ms);
  image_faults_ = images_.faults(frame);
  frame.left.copyTo(pair_.left);
  frame.right.copyTo(pair_.right);
  cloud_is_current_ = false;
  T_M_C_ = config_.map.frame_id.empty() ? Eigen::Isometry3d::Identity() : *T_W_C;
  {
    const Stopwatch stage(report_.times.stereo_ms);
    disparity_estimator_.estimate(frame, disparity_);
  }
  {
    const Stopwatch stage(report_.times.fusion_ms);
    fuseRange(frame.stamp_s);
  }
  {
    const Stopwatch stage(report_.times.cloud_ms);
    cloud_builder_.depth(disparity_, scale_, depth_);
  }
  {
    const Stopwatch stage(report_.times.map_ms);
    is_unmatched_ = isUnmatched(boxInCamera());
    updateMap();
  }
  {
    const Stopwatch stage(report_.times.corridor_ms);
    decide();
  }
  return report_;
}

std::uint32_t Pipeline::faults(const StereoFrame& frame, const std::optional<Eigen::Isometry3d>& T_W_C) const {
  const auto fits = [&](const cv::Mat& image) { return image.type() == CV_8UC1 && image.size() == geometry_.size(); };
  std::uint32_t reasons = 0;
  if (!std::isfinite(frame.stamp_s)) reasons |= kNoData;
  if (!fits(frame.left) || !fits(frame.right)) reasons |= kBadImage;
  const bool has_pose = T_W_C && T_W_C->matrix().allFinite();
  if (!config_.map.frame_id.empty() && !has_pose) reasons |= kNoPose;
  return reasons;
}

const Report& Pipeline::refuse(std::uint32_t reasons) {
  ++counters_.frames_refused;
  report_.verdict.reasons = reasons;
  return report_;
}

/// D_c from the beam's footprint, d_K from both sensors, and what the two teach about the rig's scale.
void Pipeline::fuseRange(double stamp_s) {
  const RangeEstimate expected = fusion_.at(stamp_s);
  auto stereo = beam_.read(disparity_.matched_px, expected.range_m, lidar_.beamWidth());
  if (stereo) {
    learnScale(stamp_s, *stereo, expected);
  } else {
    stereo = beam_.read(disparity_.filtered_px, expected.range_m, lidar_.beamWidth());
    if (stereo) stereo->disparity_sigma_px = std::hypot(stereo->disparity_sigma_px, kFillSigma_px);
  }
  double reference_px = geometry_.disparity(kReferenceDepth_m);
  if (stereo) {
    reference_px = stereo->disparity_px;
    report_.range_stereo_m = beam_.range(geometry_.depth(scale_.correct(stereo->disparity_px)));
    const double variance_m2 = stereoVariance(*stereo);
    counters_.stereo_gated +=
        fusion_.add(Sensor::Stereo, stamp_s, report_.range_stereo_m, variance_m2) == Outcome::Gated;
  }
  report_.range = fusion_.at(stamp_s);
  report_.range_lidar_m = lidarRange(stamp_s);
  report_.scale = scale_.scale(reference_px);
  report_.scale_sigma = scale_.sigma(reference_px);
}

/// R of D_c: the constant part, and the match's and the footprint's spread in depth (sigma_Z = Z^2/(fB) sigma_d). Not
/// what is unknown of the scale: it is the same in all readings, and would hide their jumps from the gate.
double Pipeline::stereoVariance(const FootprintReading& stereo) const {
  const double depth_m = geometry_.depth(stereo.disparity_px);
  const double match_m = geometry_.depthSigma(depth_m, config_.fusion.disparity_sigma_px);
  const double spread_m = geometry_.depthSigma(depth_m, stereo.disparity_sigma_px);
  return config_.fusion.stereo_variance_m2 + match_m * match_m + spread_m * spread_m;
}

/// The prediction that stereo has not entered yet is the reference; without a LiDAR in it there is nothing to learn,
/// and one that repeats itself may be frozen: the scale would follow it away from the truth.
void Pipeline::learnScale(double stamp_s, const FootprintReading& stereo, const RangeEstimate& expected) {
  const bool has_lidar = std::isfinite(lidarRange(stamp_s)) && !lidar_.repeatsItself();
  if (!has_lidar || expected.disagreement || !std::isfinite(expected.range_m)) return;
  if (stereo.unity < kUnity) return;  // among leaves LiDAR and stereo speak of different surfaces
  const double depth_m = beam_.depth(expected.range_m);
  const double expected_px = geometry_.disparity(depth_m);
  const double expected_sigma_px = expected_px * expected.sigma_m / depth_m;
  const double measured_sigma_px = std::hypot(config_.scale.disparity_sigma_px, stereo.disparity_sigma_px);
  scale_.update(stamp_s, stereo.disparity_px, expected_px, measured_sigma_px, expected_sigma_px);
}

/// d_L for a frame: the newest reading that was fused, not older than fusion/max_gap_s; NaN without one.
double Pipeline::lidarRange(double stamp_s) const { return lidar_.range(stamp_s, config_.fusion.max_gap_s); }

/// An image in which something was lost clears nothing: what the map calls free is believed by others, and later.
void Pipeline::updateMap() {
  if (config_.map.frame_id.empty()) {
    map_.clear();
  } else {
    map_.keepAround(T_M_C_.translation(), report_.verdict.stamp_s);
    frame_map_->clear();
    frame_map_->insert(depth_.filled_m, Eigen::Isometry3d::Identity(), !is_unmatched_, disparity_.thin);
  }
  map_.insert(depth_.filled_m, T_M_C_, !is_unmatched_, disparity_.thin);
  if (const double range_m = report_.range.range_m;
      std::isfinite(lidarRange(report_.verdict.stamp_s)) && range_m <= config_.map.max_range_m) {
    map_.insertBeam(T_M_C_ * beam_.point(0.0), T_M_C_ * beam_.point(range_m), true);
  }
}

/// What was ever seen in the box and is not known to have gone blocks it; only what this frame shows makes it free.
CorridorOccupancy Pipeline::inspectCorridor() const {
  const ConvexRegion observable_C = disparity_estimator_.observable();
  const ConvexRegion observable_M = T_M_C_.inverse().matrix().transpose() * observable_C;
  const auto inspect = [&](const OccupancyMap& map, const Eigen::Isometry3d& T_M_C, const Box& box,
                           const ConvexRegion& observable) {
    SurfaceInBox surface(config_.map, geometry_, depth_.filled_m, disparity_.thin, report_.scale_sigma, T_M_C, box);
    return corridor_.inspect(map.tree(), box, observable, [&](const Eigen::Vector3d& cell_centre, double near_m) {
      return surface.begin(cell_centre, near_m);
    });
  };
  CorridorOccupancy occupancy = inspect(map_, T_M_C_, box(), observable_M);
  if (frame_map_) {
    const CorridorOccupancy now = inspect(*frame_map_, Eigen::Isometry3d::Identity(), boxInCamera(), observable_C);
    occupancy.clear_distance_m = std::min(occupancy.clear_distance_m, now.clear_distance_m);
    occupancy.unknown_fraction = std::max(occupancy.unknown_fraction, now.unknown_fraction);
  }
  return occupancy;
}

void Pipeline::decide() {
  Verdict& verdict = report_.verdict;
  const CorridorOccupancy occupancy = inspectCorridor();
  const std::optional<double> beam_end_m = beamEndInBox();
  verdict.clear_distance_m = std::min(occupancy.clear_distance_m, beam_end_m.value_or(kInfinity));
  verdict.unknown_fraction = occupancy.unknown_fraction;

  const auto because = [&](bool holds, Reason reason) {
    if (holds) verdict.reasons |= reason;
  };
  because(std::isfinite(occupancy.clear_distance_m), kOccupiedCell);
  because(beam_end_m.has_value(), kShortRange);
  const bool blocked = verdict.reasons != 0;
  if (blocked) blocked_s_ = verdict.stamp_s;
  verdict.reasons |= image_faults_;  // one image on both topics, too: every surface would be infinitely far
  because(disparity_.matched_fraction < config_.stereo.min_matched_fraction, kNoDisparity);
  because(!(occupancy.unknown_fraction <= config_.corridor.max_unknown_fraction), kUnobserved);
  because(is_unmatched_, kUnmatched);
  because(!blocked && std::abs(verdict.stamp_s - blocked_s_) <= config_.corridor.hold_s, kRecentlyBlocked);
  because(report_.range.disagreement, kDisagreement);
  because(std::isnan(report_.range_lidar_m) || lidar_.isSlow(verdict.stamp_s), kNoLidar);
  because(lidar_.isRejected(), kLidarRejected);
  because(std::isnan(report_.range.range_m), kNoRangeObserved);
  verdict.state = state(verdict.reasons);
}

State Pipeline::state(std::uint32_t reasons) const {
  const State state = stateOf(reasons);
  return state == State::Free && isCloudTooFar() ? State::Unknown : state;
}

/// A nearer LiDAR rules the beam alone: the cloud that it contradicts may be too far everywhere. One that is farther
/// says nothing against the cloud.
bool Pipeline::isCloudTooFar() const { return report_.range.stereo_disagrees && std::isfinite(report_.range_lidar_m); }

UnmatchedTexture Pipeline::unmatchedTexture() const {
  return {geometry_, pair_, disparity_, depth_.matched_m, nearestDepth()};
}

bool Pipeline::isUnmatched(const Box& box_C) const {
  return !depth_.matched_m.empty() && !(unmatchedTexture().share(box_C) <= config_.corridor.max_unmatched_fraction);
}

cv::Mat Pipeline::unmatched() const {
  if (depth_.matched_m.empty()) return cv::Mat::zeros(geometry_.size(), CV_32FC1);
  return unmatchedTexture().image(boxInCamera());
}

Verdict Pipeline::query(const Box& box) const {
  throwIfBroken(check(box, config_.map.resolution_m), "impossible box");
  const CorridorOccupancy occupancy = inspectBox(map_.tree(), box, ConvexRegion());
  Verdict verdict;
  verdict.stamp_s = report_.verdict.stamp_s;
  verdict.clear_distance_m = occupancy.clear_distance_m;
  verdict.unknown_fraction = occupancy.unknown_fraction;

  const bool blocked = std::isfinite(occupancy.clear_distance_m);
  verdict.reasons = report_.verdict.reasons & kMapInDoubt;
  if (blocked) verdict.reasons |= kOccupiedCell;
  if (!(occupancy.unknown_fraction <= config_.corridor.max_unknown_fraction)) verdict.reasons |= kUnobserved;
  if (!blocked && isUnmatched({T_M_C_.inverse() * box.T_M_F, box.size_m})) verdict.reasons |= kUnmatched;
  if (std::isnan(verdict.stamp_s)) verdict.reasons |= kNoData;
  if (isCloudTooFar()) verdict.reasons |= kDisagreement;
  verdict.state = state(verdict.reasons);
  return verdict;
}

/// How far along the box's axis the beam ends, when that is inside the box or may be, by one sigma: d_K < D_min of the
/// paper, carried to the volume. While the sensors disagree the nearer one rules.
std::optional<double> Pipeline::beamEndInBox() const {
  double range_m = report_.range.range_m, nearest_m = range_m - report_.range.sigma_m;
  if (report_.range.disagreement) {
    range_m = std::fmin(range_m, report_.range.disagreeing_m);
    nearest_m = std::fmin(nearest_m, range_m);
  }
  if (!std::isfinite(nearest_m)) return std::nullopt;
  const Box box = boxInCamera();
  const bool ends_inside = contains(box, beam_.point(range_m)) || contains(box, beam_.point(nearest_m));
  if (!ends_inside) return std::nullopt;  // a large sigma reaches behind the box
  return std::clamp((box.T_M_F.inverse() * beam_.point(range_m)).x(), 0.0, box.size_m.x());
}

const Cloud& Pipeline::cloud() {
  if (!cloud_is_current_ && !pair_.left.empty()) {
    cloud_builder_.cloud(depth_.filled_m, pair_.left, config_.map.resolution_m, cloud_);
    cloud_is_current_ = true;
  }
  return cloud_;
}

void Pipeline::reset() {
  fusion_.reset();
  scale_.reset();
  map_.clear();
  lidar_ = LidarWatch();
  images_ = ImageWatch();
  blocked_s_ = -kInfinity;
  report_ = Report();
  pair_ = StereoFrame();
  disparity_ = Disparity();
  depth_ = DepthImages();
  cloud_.clear();
}

}  // namespace flight_corridor
