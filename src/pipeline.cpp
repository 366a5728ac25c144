#include "flight_corridor/pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/core.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "flight_corridor/corridor/railing.hpp"
#include "flight_corridor/geometry/cross_sections.hpp"

namespace flight_corridor {

namespace {

constexpr std::uint32_t kMapInDoubt =  // reasons of a frame that left no evidence in the map, or none to trust
    kNoData | kNoPose | kBadImage | kBadCalibration | kFrozenImage | kDisagreement | kLidarNearer;

constexpr double kLatestSight = 0.75;  // of the corridor: of its last quarter, the end, all has to be known

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

MapConfig ofOneImage(MapConfig config) {
  config.frame_id.clear();
  return config;
}

const Config& valid(const Config& config) {
  throwIfBroken(check(config));
  return config;
}

/// A baseline in another unit, or too few disparities: what stereo sees begins where the corridor is all but over.
/// @throws std::invalid_argument
void requireSight(const CorridorConfig& corridor, const StereoGeometry& geometry, double nearest_m) {
  const double end_m = corridor.offset_m.x() + corridor.length_m + corridor.margin_m;
  if (nearest_m <= kLatestSight * end_m) return;
  std::ostringstream text;
  text << "stereo sees nothing nearer than " << nearest_m << " m, in or beyond the last quarter of the corridor's "
       << end_m << " m (corridor/length_m): see that the baseline of " << geometry.calibration().baseline_m
       << " m is right, or search a larger stereo/num_disparities_px";
  throw std::invalid_argument(text.str());
}

/// Repeated matches that are where the LiDAR met the pattern, to a pixel, are no longer in question.
/// @param met_px corrected disparity of what it met; NaN: nothing.
void confirmRepeated(double met_px, const ScaleCorrection& correction, Disparity& disparity) {
  if (std::isnan(met_px)) return;
  float *best_px = disparity.best_px.ptr<float>(), *repeated_px = disparity.repeated_px.ptr<float>();
  const std::size_t pixels = disparity.best_px.total();
  for (std::size_t i = 0; i < pixels; ++i) {
    if (std::abs(correction.correct(repeated_px[i]) - met_px) <= 1.0) std::swap(best_px[i], repeated_px[i]);
  }
}

}  // namespace

Pipeline::Pipeline(const Config& config, const StereoGeometry& geometry, const Rig& rig)
    : config_(valid(config)),
      geometry_(geometry),
      rig_(rig),
      disparity_estimator_(config.stereo, geometry, config.corridor.smallest_obstacle_m),
      range_tracker_(config.lidar, config.fusion, config.scale, geometry, rig.T_C_L),
      map_(config.map, geometry, nearestDepth()),
      corridor_(config.corridor),
      recent_block_(config.corridor.hold_s, config.map.resolution_m),
      box_view_(geometry),
      doubt_(geometry, config.corridor.smallest_obstacle_m) {
  requireSight(config.corridor, geometry, nearestDepth());
  if (!config.map.frame_id.empty()) frame_map_.emplace(ofOneImage(config.map), geometry, nearestDepth());
}

const Report& Pipeline::process(const StereoFrame& frame, const std::optional<Eigen::Isometry3d>& T_W_C) {
  report_ = Report();
  report_.verdict.stamp_s = frame.stamp_s;
  ++counters_.frames;
  if (const std::uint32_t reasons = faults(frame, T_W_C)) return refuse(reasons);
  const Stopwatch total(report_.times.total_ms);
  newest_stamp_s_ = frame.stamp_s;
  image_faults_ = images_.faults(frame);
  frame.left.copyTo(pair_.left);
  frame.right.copyTo(pair_.right);
  T_M_C_ = config_.map.frame_id.empty() ? Eigen::Isometry3d::Identity() : *T_W_C;
  {
    const Stopwatch stage(report_.times.stereo_ms);
    disparity_estimator_.estimate(frame, disparity_);
  }
  {
    const Stopwatch stage(report_.times.fusion_ms);
    trackRange();
    confirmRepeated(geometry_.disparity(validLidarDepth(boxInCamera())), scale(), disparity_);
  }
  {
    const Stopwatch stage(report_.times.cloud_ms);
    correctedDepth(disparity_.best_px, scale(), geometry_, depth_m_);
  }
  {
    const Stopwatch stage(report_.times.map_ms);
    doubts_ = doubts(boxInCamera(), box_view_, doubt_);
    report_.clears = isTrusted();
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
  if (!std::isfinite(frame.stamp_s) || frame.stamp_s < newest_stamp_s_) reasons |= kNoData;
  if (!fits(frame.left) || !fits(frame.right)) reasons |= kBadImage;
  const bool has_pose = T_W_C && T_W_C->matrix().allFinite() && isRotation(T_W_C->linear());
  if (!config_.map.frame_id.empty() && !has_pose) reasons |= kNoPose;
  return reasons;
}

const Report& Pipeline::refuse(std::uint32_t reasons) {
  ++counters_.frames_refused;
  report_.verdict.reasons = reasons;
  return report_;
}

void Pipeline::trackRange() {
  TrackedRange& tracked = report_;
  tracked = range_tracker_.update(report_.verdict.stamp_s, disparity_.best_px);
  static_cast<RangeCounts&>(counters_) = range_tracker_.counts();
}

/// Whether the cloud is complete, of now, and not too far everywhere. A nearer LiDAR rules the beam alone and
/// contradicts all of it; one that is farther says nothing against it. What is in doubt clears nothing (the beam clears
/// its own cells): what the map calls free is believed by others, and later.
bool Pipeline::isTrusted() const { return image_faults_ == 0 && doubts_ == 0 && !report_.lidar_is_nearer; }

void Pipeline::updateMap() {
  if (config_.map.frame_id.empty()) {
    map_.clear();
  } else {
    map_.keepAround(T_M_C_.translation(), report_.verdict.stamp_s);
    frame_map_->clear();
    frame_map_->insert(depth_m_, Eigen::Isometry3d::Identity(), report_.clears);
  }
  map_.insert(depth_m_, T_M_C_, report_.clears);
  if (const double range_m = report_.range.range_m;
      std::isfinite(report_.range_lidar_m) && range_m <= config_.map.max_range_m) {
    map_.insertBeam(T_M_C_ * range_tracker_.point(0.0), T_M_C_ * range_tracker_.point(range_m));
  }
}

/// What was ever seen in the box and is not known to have gone blocks it; only what this frame shows makes it free.
CorridorOccupancy Pipeline::inspectCorridor() const {
  const ConvexRegion observable_C = disparity_estimator_.observable();
  const ConvexRegion observable_M = T_M_C_.inverse().matrix().transpose() * observable_C;
  const auto inspect = [&](const OccupancyMap& map, const Eigen::Isometry3d& T_M_C, const Box& box,
                           const ConvexRegion& observable) {
    SurfaceInBox surface(config_.map, geometry_, depth_m_, report_.scale_sigma, T_M_C, box, &scratch_);
    return corridor_.inspect(
        map.tree(), box, T_M_C.translation(), observable,
        [&](const Eigen::Vector3d& cell_centre, double near_m) { return surface.begin(cell_centre, near_m); });
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

  verdict.reasons = mapReasons(occupancy, box()) | doubts_ | reasonsOf(report_);
  verdict.reasons |= image_faults_;  // one image on both topics, too: every surface would be infinitely far
  if (beam_end_m) verdict.reasons |= kShortRange;
  if (stateOf(verdict.reasons) == State::Blocked) {
    recent_block_.note(verdict, beam_end_m, frameMap(), boxInCamera(), &scratch_);
  } else if (recent_block_.mayRemain(verdict.stamp_s, frameMap(), boxInCamera())) {
    verdict.reasons |= kRecentlyBlocked;
  }
  verdict.state = stateOf(verdict.reasons);
}

/// What the map says of a box.
std::uint32_t Pipeline::mapReasons(const CorridorOccupancy& occupancy, const Box& box_M) const {
  const std::uint32_t reasons = reasonsOf(occupancy, config_.corridor.max_unknown_fraction);
  return reasons & kOccupiedCell || !map_.showsOutline(box_M) ? reasons : reasons | kWeakEvidence;
}

/// Why the newest pair's matches are not enough to call a box free.
std::uint32_t Pipeline::doubts(const Box& box_C, BoxView& view, Doubt& doubt) const {
  const bool is_lidar_valid = !std::isnan(validLidarDepth(box_C));
  view.look(box_C, config_.corridor.blind_m);
  std::uint32_t reasons = 0;
  if (!(disparity_.matched_fraction >= config_.stereo.min_matched_fraction)) reasons |= kNoDisparity;
  if (doubt.isIn(view, disparity_, scale(), is_lidar_valid) ||
      mayBeRailing(box_C, pair_, depth_m_, nearestDepth(), is_lidar_valid, geometry_, &scratch_)) {
    reasons |= kAmbiguous;
  }
  return reasons;
}

/// Of what the LiDAR's beam meets in the view of a box's end; NaN when it meets nothing there: a pattern in that view
/// is where the LiDAR measures it.
double Pipeline::validLidarDepth(const Box& box_C) const {
  const Eigen::Vector3d met_C = range_tracker_.point(report_.range.range_m);
  const Eigen::Vector2d pixel = geometry_.project(met_C);
  const bool is_valid = report_.lidar_range_valid && geometry_.contains(pixel) &&
                        viewOfEnd(box_C, geometry_).contains(cv::Point2d(pixel.x(), pixel.y()));
  return is_valid ? met_C.z() : kNaN;
}

Verdict Pipeline::query(const Box& box) const {
  throwIfBroken(check(box, config_.map.resolution_m), "impossible box");
  const CorridorOccupancy occupancy = inspectBox(map_.tree(), box, ConvexRegion());
  Verdict verdict;
  verdict.stamp_s = report_.verdict.stamp_s;
  verdict.clear_distance_m = occupancy.clear_distance_m;
  verdict.unknown_fraction = occupancy.unknown_fraction;

  verdict.reasons = mapReasons(occupancy, box) | (report_.verdict.reasons & kMapInDoubt);
  if (std::isnan(verdict.stamp_s)) verdict.reasons |= kNoData;
  if (stateOf(verdict.reasons) != State::Blocked && !depth_m_.empty()) {
    BoxView view(geometry_);
    Doubt doubt(geometry_, config_.corridor.smallest_obstacle_m);
    verdict.reasons |= doubts(inCamera(box), view, doubt);
  }
  verdict.state = stateOf(verdict.reasons);
  return verdict;
}

/// How far along the box's axis the beam ends, when that is inside the box or may be, by one sigma: d_K < D_min of the
/// paper, carried to the volume. While the sensors disagree the nearer one rules.
std::optional<double> Pipeline::beamEndInBox() const {
  double range_m = report_.range.range_m, nearest_m = range_m - report_.range.sigma_m;
  if (report_.range.dissent) {
    range_m = std::fmin(range_m, report_.range.dissent->range_m);
    nearest_m = std::fmin(nearest_m, range_m);
  }
  if (!std::isfinite(nearest_m)) return std::nullopt;
  const Box box = boxInCamera();
  const bool ends_inside =
      contains(box, range_tracker_.point(range_m)) || contains(box, range_tracker_.point(nearest_m));
  if (!ends_inside) return std::nullopt;  // a large sigma reaches behind the box
  return std::clamp((box.T_M_F.inverse() * range_tracker_.point(range_m)).x(), 0.0, box.size_m.x());
}

void Pipeline::setCorridor(const CorridorConfig& corridor) {
  Config changed = config_;
  changed.corridor = corridor;
  throwIfBroken(check(changed));
  requireSight(corridor, geometry_, nearestDepth());
  config_ = changed;
  corridor_ = Corridor(corridor);
  recent_block_.setHold(corridor.hold_s);
  disparity_estimator_.setSmallestObstacle(corridor.smallest_obstacle_m);
  doubt_.setSmallestObstacle(corridor.smallest_obstacle_m);
}

void Pipeline::takeOver(const Pipeline& before) {
  images_ = before.images_;
  recent_block_.takeOver(before.recent_block_);
}

}  // namespace flight_corridor
