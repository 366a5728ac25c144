#include "flight_corridor/pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/core.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "flight_corridor/geometry/section.hpp"

namespace flight_corridor {

namespace {

constexpr std::uint32_t kMapInDoubt =  // reasons of a frame that left no evidence in the map, or none to trust
    kNoData | kNoPose | kBadImage | kBadCalibration | kFrozenImage | kNoDisparity | kDisagreement | kLidarNearer;

constexpr double kLatestSight = 0.75;    // of the corridor: of its last quarter, the end, most has to be known
constexpr double kMostUnknown = 0.1;     // of a box that is asked about
constexpr double kScanned_rad = 0.7;       // to the left and to the right: about the view of a camera
constexpr double kNearestAsked_m = 0.1;  // from the camera on it must be known

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

/// Share of a box nearer than a depth, or behind the camera, by its slices along its axis.
double shareNearer(const Box& box_C, double depth_m) {
  constexpr int kSlices = 64;
  int nearer = 0;
  for (int i = 0; i < kSlices; ++i) {
    const double along_m = box_C.size_m.x() * (i + 0.5) / kSlices;
    nearer += !((box_C.T_M_F * Eigen::Vector3d(along_m, 0.0, 0.0)).z() >= depth_m);
  }
  return static_cast<double>(nearer) / kSlices;
}

/// @param distance_m to what blocks; +inf: nothing does.
void block(Reason reason, double distance_m, Verdict& verdict) {
  if (!std::isfinite(distance_m)) return;
  verdict.reasons |= reason;
  verdict.clear_distance_m = std::min(verdict.clear_distance_m, distance_m);
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
  std::size_t confirmed = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    if (!(std::abs(correction.correct(repeated_px[i]) - met_px) <= 1.0)) continue;
    std::swap(best_px[i], repeated_px[i]);
    ++confirmed;
  }
  disparity.matched_fraction += static_cast<double>(confirmed) / static_cast<double>(pixels);
}

}  // namespace

Pipeline::Pipeline(const Config& config, const StereoGeometry& geometry, const Rig& rig)
    : config_(valid(config)),
      geometry_(geometry),
      rig_(rig),
      disparity_estimator_(config.stereo, geometry, config.corridor.smallest_obstacle_m),
      range_tracker_(config.lidar, config.fusion, config.scale, geometry, rig.T_C_L),
      map_(config.map, geometry, nearestDepth()),
      rays_(geometry),
      inspector_(geometry),
      query_inspector_(geometry),
      fan_inspector_(geometry),
      recent_block_(config.corridor.hold_s) {
  requireSight(config.corridor, geometry, nearestDepth());
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
bool Pipeline::isTrusted() const {
  return image_faults_ == 0 && (box_reasons_ & (kAmbiguous | kNoDisparity)) == 0 && !report_.lidar_is_nearer;
}

void Pipeline::updateMap() const {
  is_map_current_ = true;
  if (remembers()) {
    map_.keepAround(T_M_C_.translation(), report_.verdict.stamp_s);
  } else {
    map_.clear();
  }
  map_.insert(depth_m_, T_M_C_, report_.clears);
  if (const double range_m = report_.range.range_m;
      std::isfinite(report_.range_lidar_m) && range_m <= config_.map.max_range_m) {
    map_.insertBeam(T_M_C_ * range_tracker_.point(0.0), T_M_C_ * range_tracker_.point(range_m));
  }
}

const OccupancyMap& Pipeline::map() const {
  if (!is_map_current_) updateMap();
  return map_;
}

PairEvidence Pipeline::evidence() const {
  return {pair_, disparity_, depth_m_, left_texture_.mask(), rays_, scale(), nearestDepth()};
}

/// What was ever seen in the box and is not known to have gone blocks it; only what this frame shows makes it free.
void Pipeline::decide() {
  Verdict& verdict = report_.verdict;
  const CorridorConfig& corridor = config_.corridor;
  const Box box_C = boxInCamera();
  const double smallest_m = smallestInspected(corridor);
  BandWorkers& workers = disparity_estimator_.workers();
  workers.run(2, [&](int side, int) { side == 0 ? left_texture_.find(pair_.left) : right_texture_.find(pair_.right); });
  rays_.look(disparity_, left_texture_.mask(), right_texture_.mask(), scale(), workers);
  const BoxEvidence& shown =
      inspector_.inspect(box_C, evidence(), corridor.blind_m, smallest_m, isLidarValid(box_C), workers).front();
  box_reasons_ = reasonsOf(shown, corridor, verdict.clear_distance_m);
  if (!(disparity_.matched_fraction >= config_.stereo.min_matched_fraction)) box_reasons_ |= kNoDisparity;
  verdict.unknown_fraction = shown.unobserved.fraction;
  verdict.reasons = box_reasons_ | reasonsOf(report_);
  verdict.reasons |= image_faults_;  // one image on both topics, too: every surface would be infinitely far
  block(kShortRange, beamEndInBox(box_C), verdict);
  if (remembers()) block(kOccupiedCell, cellsIn(map_.tree(), box()).clear_distance_m, verdict);
  if (stateOf(verdict.reasons) == State::Blocked) {
    recent_block_.onBlocked(verdict, shown.patches, smallest_m);
  } else if (recent_block_.mayRemain(verdict.stamp_s, shown.patches, smallest_m)) {
    verdict.reasons |= kRecentlyBlocked;
  }
  verdict.state = stateOf(verdict.reasons);
  verdict.free_distance_m = freeDistance(verdict, shown.unobserved, box_C);
  report_.clears = isTrusted();
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
  Verdict verdict;
  verdict.stamp_s = report_.verdict.stamp_s;
  verdict.clear_distance_m = kInfinity;
  verdict.reasons = report_.verdict.reasons & kMapInDoubt;
  if (std::isnan(verdict.stamp_s) || depth_m_.empty()) {
    verdict.reasons |= kNoData;
    return verdict;
  }
  const Box box_C{T_M_C_.inverse() * box.T_M_F, box.size_m};
  const bool is_way = beginsAtUav(box_C);
  const BoxEvidence& shown = query_inspector_
                                 .inspect(box_C, evidence(), is_way ? config_.corridor.blind_m : kNearestAsked_m,
                                          smallestInspected(config_.corridor), isLidarValid(box_C),
                                          disparity_estimator_.workers())
                                 .front();
  verdict.reasons |= reasonsOf(shown, config_.corridor, verdict.clear_distance_m);
  const Unobserved& unobserved = shown.unobserved;
  verdict.unknown_fraction = unobserved.fraction;
  if (!is_way) {
    const double too_near = shareNearer(box_C, kNearestAsked_m);
    const double unseen = too_near + (1.0 - too_near) * unobserved.out_of_view;
    verdict.unknown_fraction = unseen + (1.0 - unseen) * unobserved.fraction;
    if (verdict.unknown_fraction > kMostUnknown) verdict.reasons |= kUnobserved;
  }
  block(kShortRange, beamEndInBox(box_C), verdict);
  if (is_cleared_) {
    verdict.unknown_fraction = std::max(verdict.unknown_fraction, cellsIn(map_.tree(), box).unknown_fraction);
    if (verdict.unknown_fraction > kMostUnknown) verdict.reasons |= kUnobserved;
  }
  if (remembers()) {
    const BoxCells remembered = cellsIn(map().tree(), box);
    if (!is_cleared_) verdict.unknown_fraction = std::min(verdict.unknown_fraction, remembered.unknown_fraction);
    block(kOccupiedCell, remembered.clear_distance_m, verdict);
    const bool is_known = !unobserved.hasHole() && verdict.unknown_fraction <= kMostUnknown;
    if (is_known) verdict.reasons &= ~kUnobserved;  // memory says the rest
  }
  verdict.state = stateOf(verdict.reasons);
  return verdict;
}

std::vector<bool> Pipeline::isLidarValid(const Fan& fan_C) const {
  std::vector<bool> is_valid;
  for (int i = 0; i < fan_C.size(); ++i) is_valid.push_back(!std::isnan(validLidarDepth(fan_C.box(i))));
  return is_valid;
}

/// By the corridor's rule: each box begins at the UAV.
std::vector<Verdict> Pipeline::judge(const Fan& fan_C) {
  std::vector<Verdict> verdicts(fan_C.size());
  if (depth_m_.empty()) {
    for (Verdict& verdict : verdicts) verdict.reasons = kNoData;
    return verdicts;
  }
  const std::vector<BoxEvidence>& shown =
      fan_inspector_.inspect(fan_C, evidence(), config_.corridor.blind_m, smallestInspected(config_.corridor),
                             isLidarValid(fan_C), disparity_estimator_.workers());
  for (int i = 0; i < fan_C.size(); ++i) {
    Verdict& verdict = verdicts[i];
    const Box box_C = fan_C.box(i);
    verdict.stamp_s = report_.verdict.stamp_s;
    verdict.reasons =
        (report_.verdict.reasons & kMapInDoubt) | reasonsOf(shown[i], config_.corridor, verdict.clear_distance_m);
    verdict.unknown_fraction = shown[i].unobserved.fraction;
    block(kShortRange, beamEndInBox(box_C), verdict);
    if (remembers()) block(kOccupiedCell, cellsIn(map_.tree(), {T_M_C_ * box_C.T_M_F, box_C.size_m}).clear_distance_m, verdict);
    verdict.state = stateOf(verdict.reasons);
    verdict.free_distance_m = freeDistance(verdict, shown[i].unobserved, box_C);
  }
  return verdicts;
}

const AreaGrid& Pipeline::freeAreas(const std::optional<Eigen::Vector3d>& goal_C) {
  const FreeAreasConfig& config = config_.free_areas;
  const Fan fan_C(boxInCamera(), gridAngles(config.yaw_rad, config.step_rad),
                  gridAngles(config.pitch_rad, config.step_rad));
  const std::vector<Verdict> verdicts = judge(fan_C);
  free_areas_ = areaGrid(config);
  for (std::size_t i = 0; i < verdicts.size(); ++i) free_areas_.areas[i].verdict = verdicts[i];
  const Eigen::Vector3d ahead_C = rig_.T_C_F.linear().col(0);
  free_areas_.best =
      bestArea(free_areas_, rig_.T_C_F.linear().transpose() * goal_C.value_or(ahead_C), config.step_rad);
  return free_areas_;
}

LevelScan Pipeline::levelScan(const Eigen::Matrix3d& R_C_H) {
  LevelScan scan;
  scan.step_rad = config_.free_areas.step_rad;
  const std::vector<double> yaws_rad = gridAngles(kScanned_rad, scan.step_rad);
  scan.first_yaw_rad = yaws_rad.front();
  scan.max_range_m = config_.corridor.length_m;
  const double width_m = 2.0 * scan.max_range_m * std::tan(0.5 * scan.step_rad);
  const Box ahead_C{Eigen::Isometry3d(R_C_H), {scan.max_range_m, width_m, config_.corridor.height_m}};
  for (const Verdict& verdict : judge({ahead_C, yaws_rad, {0.0}})) {
    scan.range_m.push_back(verdict.state == State::Unknown ? kNaN : verdict.clear_distance_m);
  }
  return scan;
}

/// Whether it is a way that the UAV may take from where it is: then it is judged as the corridor. What of it is out of
/// view, beside the camera, was seen from farther away, or is where the UAV is.
bool Pipeline::beginsAtUav(const Box& box_C) const {
  const Eigen::Vector3d away_C = box_C.T_M_F.translation() - boxInCamera().T_M_F.translation();
  return away_C.norm() <= 0.5 * config_.corridor.width_m;
}

/// How far along the box's axis the beam ends, when that is inside the box or may be, by one sigma: d_K < D_min of the
/// paper, carried to the volume; +inf: it does not. While the sensors disagree the nearer one rules.
double Pipeline::beamEndInBox(const Box& box) const {
  double range_m = report_.range.range_m, nearest_m = range_m - report_.range.sigma_m;
  if (report_.range.disagreement) {
    range_m = std::fmin(range_m, report_.range.disagreement->range_m);
    nearest_m = std::fmin(nearest_m, range_m);
  }
  if (!std::isfinite(nearest_m)) return kInfinity;
  const bool ends_inside =
      contains(box, range_tracker_.point(range_m)) || contains(box, range_tracker_.point(nearest_m));
  if (!ends_inside) return kInfinity;  // a large sigma reaches behind the box
  return std::clamp((box.T_M_F.inverse() * range_tracker_.point(range_m)).x(), 0.0, box.size_m.x());
}

void Pipeline::setCorridor(const CorridorConfig& corridor) {
  Config changed = config_;
  changed.corridor = corridor;
  throwIfBroken(check(changed));
  requireSight(corridor, geometry_, nearestDepth());
  config_ = changed;
  recent_block_.setHold(corridor.hold_s);
  disparity_estimator_.setSmallestObstacle(corridor.smallest_obstacle_m);
}

void Pipeline::takeOver(const Pipeline& before) {
  images_ = before.images_;
  recent_block_.takeOver(before.recent_block_);
}

}  // namespace flight_corridor
