#include "flight_corridor/pipeline.hpp"

#include <chrono>
#include <cmath>
#include <opencv2/core.hpp>
#include <sstream>
#include <stdexcept>

#include "flight_corridor/geometry/section.hpp"
#include "flight_corridor/stereo/match_error.hpp"

namespace flight_corridor {

namespace {

constexpr double kLatestSight = 0.75;  // of the corridor: of its last quarter, the end, most has to be known

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

const Config& valid(const Config& config) {
  throwIfBroken(check(config));
  return config;
}

/// A baseline in another unit, or too few disparities: stereo begins to see only near the corridor's end.
/// @throws std::invalid_argument
void requireSight(const CorridorConfig& corridor, const StereoGeometry& geometry, double nearest_m) {
  const double end_m = corridor.offset_m.x() + corridor.length_m + corridor.margin_m;
  if (nearest_m <= kLatestSight * end_m) return;
  std::ostringstream text;
  text << "stereo sees nothing nearer than " << nearest_m << " m, in or beyond the last quarter of the corridor's "
       << end_m << " m (corridor/length_m): check that the baseline of " << geometry.calibration().baseline_m
       << " m is right, or raise stereo/num_disparities_px";
  throw std::invalid_argument(text.str());
}

/// Of a camera within the map's reach.
bool isPose(const std::optional<Eigen::Isometry3d>& T_W_C, const MapConfig& map) {
  return T_W_C && T_W_C->matrix().allFinite() && isRotation(T_W_C->linear()) &&
         (T_W_C->translation().array().abs() <= farthestCamera(map)).all();
}

/// Repeated matches of the surface that the LiDAR measured are confirmed.
/// @param lidar_px its corrected disparity; NaN: none.
void confirmRepeated(double lidar_px, const ScaleCorrection& correction, Disparity& disparity) {
  if (std::isnan(lidar_px)) return;
  float *best_px = disparity.best_px.ptr<float>(), *repeated_px = disparity.repeated_px.ptr<float>();
  const std::size_t pixels = disparity.best_px.total();
  std::size_t confirmed = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    if (!isOneSurface(correction.correct(repeated_px[i]), lidar_px)) continue;
    std::swap(best_px[i], repeated_px[i]);
    ++confirmed;
  }
  disparity.matched_fraction += static_cast<double>(confirmed) / static_cast<double>(pixels);
}

}  // namespace

Pipeline::Pipeline(const Config& config, const StereoGeometry& geometry, const Rig& rig,
                   const DeviceMatcherFactory& make_device_matcher)
    : config_(valid(config)),
      geometry_(geometry),
      rig_(rig),
      covered_(coveredPixels(rig.own_parts, geometry.size())),
      disparity_estimator_(config.stereo, geometry, config.corridor.smallest_obstacle_m, make_device_matcher),
      range_tracker_(config.lidar, config.fusion, config.scale, geometry, rig.T_C_L),
      map_(config.map, geometry, disparity_estimator_.nearestDepth()),
      rays_(geometry),
      gaps_(geometry),
      inspector_(geometry),
      query_inspector_(geometry),
      fan_inspector_(geometry),
      movers_(geometry),
      rectification_(geometry),
      motion_(geometry),
      earlier_(geometry),
      earlier_matches_(geometry, disparity_estimator_.nearestDepth()),
      obstacles_(config.map) {
  requireSight(config.corridor, geometry, disparity_estimator_.nearestDepth());
  disparity_estimator_.setCovered(covered_);
}

const Report& Pipeline::process(const StereoFrame& frame, const std::optional<Eigen::Isometry3d>& T_W_C) {
  report_ = Report();
  report_.verdict.stamp_s = frame.stamp_s;
  ++counters_.frames;
  if (const std::uint32_t reasons = faults(frame, T_W_C)) return refuse(reasons);
  const Stopwatch total(report_.times.total_ms);
  newest_stamp_s_ = frame.stamp_s;
  rememberMatches();
  image_faults_ = images_.faults(frame);
  T_M_C_ = config_.map.frame_id.empty() ? Eigen::Isometry3d::Identity() : *T_W_C;
  {
    const Stopwatch stage(report_.times.stereo_ms);
    report_.rows = rectification_.look(frame, pair_);
    frame.left.copyTo(pair_.left);
    frame.right.copyTo(pair_.right);
    disparity_estimator_.estimate(frame, disparity_);
  }
  {
    const Stopwatch stage(report_.times.fusion_ms);
    trackRange();
    remember();
    disparity_estimator_.workers().run(3, [&](int part, int) {  // the longest first
      if (part == 0) return followMotion(isPose(T_W_C, config_.map) ? T_W_C : std::nullopt);
      part == 1 ? left_texture_.find(pair_.left, covered_) : right_texture_.find(pair_.right);
    });
    confirmRepeated(lidarDisparity(boxInCamera()), scale(), disparity_);
  }
  {
    const Stopwatch stage(report_.times.cloud_ms);
    findDepth();
  }
  {
    const Stopwatch stage(report_.times.corridor_ms);
    decide();
  }
  {
    const Stopwatch stage(report_.times.map_ms);
    is_map_current_ = is_cleared_ = false;
    if (remembers()) updateMap();
  }
  return report_;
}

std::uint32_t Pipeline::faults(const StereoFrame& frame, const std::optional<Eigen::Isometry3d>& T_W_C) const {
  const auto fits = [&](const cv::Mat& image) { return image.type() == CV_8UC1 && image.size() == geometry_.size(); };
  std::uint32_t reasons = 0;
  if (!std::isfinite(frame.stamp_s) || frame.stamp_s < newest_stamp_s_) reasons |= kNoData;
  if (!fits(frame.left) || !fits(frame.right)) reasons |= kBadImage;
  const bool has_pose = isPose(T_W_C, config_.map);
  if (!config_.map.frame_id.empty() && !has_pose) reasons |= kNoPose;
  return reasons;
}

const Report& Pipeline::refuse(std::uint32_t reasons) {
  ++counters_.frames_refused;
  report_.verdict.reasons = reasons;
  return report_;
}

void Pipeline::findDepth() {
  constexpr int kParts = 8;
  depth_m_.create(geometry_.size(), CV_32FC1);
  disparity_estimator_.workers().run(kParts, [&](int part, int) {
    const cv::Range rows(depth_m_.rows * part / kParts, depth_m_.rows * (part + 1) / kParts);
    cv::Mat depth_m = depth_m_.rowRange(rows);
    correctedDepth(disparity_.best_px.rowRange(rows), scale(), geometry_, depth_m);
  });
}

void Pipeline::trackRange() {
  TrackedRange& tracked = report_;
  tracked = range_tracker_.update(report_.verdict.stamp_s, disparity_.best_px);
  static_cast<RangeCounts&>(counters_) = range_tracker_.counts();
}

/// Whether the cloud is complete, of now, and not too far everywhere. A nearer LiDAR rules only the beam, but
/// contradicts the whole cloud; a farther one does not. A pair in doubt clears nothing (the beam clears its own cells),
/// because others rely on the map's free space, and later.
bool Pipeline::isTrusted() const {
  return image_faults_ == 0 && (report_.verdict.reasons & (kAmbiguous | kNoDisparity | kBadCalibration)) == 0 &&
         !report_.lidar_is_nearer;
}

const cv::Mat& Pipeline::texturedDepth() const {
  textured_m_.create(depth_m_.size(), CV_32FC1);
  textured_m_.setTo(kNaN);
  depth_m_.copyTo(textured_m_, left_texture_.mask());
  return textured_m_;
}

double Pipeline::nearestDepth() const {
  return geometry_.depth(scale().correct(geometry_.disparity(disparity_estimator_.nearestDepth())));
}

PairEvidence Pipeline::evidence() const {
  return {pair_,    disparity_,
          depth_m_, left_texture_.mask(),
          rays_,    gaps_,
          earlier_, earlier_matches_,
          scale(),  disparity_estimator_.nearestDepth()};
}

/// An obstacle seen earlier in the box blocks until it is known to have gone; only this frame's evidence makes FREE.
void Pipeline::decide() {
  const CorridorConfig& corridor = config_.corridor;
  const Box box_C = boxInCamera();
  BandWorkers& workers = disparity_estimator_.workers();
  earlier_.look(disparity_, left_texture_.mask());
  const auto look_at_rays = [&](int part) {
    rays_.look(part, disparity_, left_texture_.mask(), right_texture_.mask(), scale());
  };
  const auto find_gaps = [&] {
    gaps_.find(disparity_.best_px, left_texture_.mask(), scale(), smallestInspected(corridor));
  };
  const auto look_for_movers = [&] {
    const auto pose = image_faults_ == 0 ? motion_.pose() : std::nullopt;
    movers_.look(report_.verdict.stamp_s, pose, depth_m_, left_texture_.mask(), earlier_);
  };
  workers.run(2 + ClearRays::kParts, [&](int part, int) {  // the longest first
    if (part >= 2) return look_at_rays(part - 2);
    if (part == 1) return find_gaps();
    if (config_.speed.mover_mps > 0.0) look_for_movers();
  });
  if (report_.lidar_is_new) {
    const double met_m = std::fmin(report_.range.range_m, report_.range_lidar_m);
    rays_.clearPlainSurface(disparity_, left_texture_.mask(), scale(), range_tracker_.point(met_m));
  }
  rays_.hide(left_texture_.clipped());
  std::uint32_t pair_reasons = image_faults_ | reasonsOf(report_);
  if (!(disparity_.matched_fraction >= config_.stereo.min_matched_fraction)) pair_reasons |= kNoDisparity;
  if (report_.rows.fault != RowFault::None || motion_.witness().contradicts()) pair_reasons |= kBadCalibration;
  if (!motion_.pose()) pair_reasons |= kNoMotion;
  Verdict& verdict = report_.verdict;
  recent_.moveTo(verdict.stamp_s, motion_.pose(), corridor.hold_s);
  verdict = judge(box_C, inspector_, pair_reasons).front();
  verdict.limit(movers_.freeUpTo(box_C, config_.speed));
  report_.clears = clears_ = isTrusted();
  keeps_matches_ = image_faults_ == 0 && (verdict.reasons & (kNoDisparity | kBadCalibration)) == 0;
  updateObstacles();
  judged_s_ = verdict.stamp_s;
}

void Pipeline::setCorridor(const CorridorConfig& corridor) {
  Config changed = config_;
  changed.corridor = corridor;
  throwIfBroken(check(changed));
  requireSight(corridor, geometry_, disparity_estimator_.nearestDepth());
  config_ = changed;
  disparity_estimator_.setSmallestObstacle(corridor.smallest_obstacle_m);
}

void Pipeline::takeOver(const Pipeline& before) {
  images_ = before.images_;
  recent_.takeOver(before.recent_);
}

}  // namespace flight_corridor
