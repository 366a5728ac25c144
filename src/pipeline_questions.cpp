#include <algorithm>
#include <cmath>

#include "flight_corridor/geometry/section.hpp"
#include "flight_corridor/pipeline.hpp"

// The last pair's verdicts on other boxes than the corridor.

namespace flight_corridor {

namespace {

constexpr std::uint32_t kMapInDoubt =  // reasons of a frame without evidence, or without trusted evidence, in the map
    kNoData | kNoPose | kBadImage | kBadCalibration | kFrozenImage | kNoDisparity | kDisagreement | kLidarNearer;

constexpr double kMostUnknown = 0.1;      // of a box that is asked about
constexpr double kNearestAsked_m = 0.1;   // from the camera on it must be known
constexpr double kSameObstacle_m = 0.15;  // so far apart a verdict's distance and a patch's beginning are of one

/// Whether a patch shows what blocks a box.
bool isShown(const Verdict& verdict, const std::vector<BoxPatch>& patches, double smallest_m) {
  return std::any_of(patches.begin(), patches.end(), [&](const BoxPatch& patch) {
    return patch.blocks(smallest_m * smallest_m) &&
           std::abs(patch.begin_m - verdict.clear_distance_m) <= kSameObstacle_m;
  });
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

/// Share of a box that the last pair does not show clear; from near the camera on what is out of view counts.
double unknownShare(const Box& box_C, const Unobserved& unobserved) {
  const double too_near = shareNearer(box_C, kNearestAsked_m);
  const double unseen = too_near + (1.0 - too_near) * unobserved.out_of_view;
  return unseen + (1.0 - unseen) * unobserved.fraction;
}

}  // namespace

/// Disparity of the surface that the LiDAR measured in the view of a box's end, NaN if there is none: it places what
/// is matched there.
double Pipeline::lidarDisparity(const Box& box_C) const {
  const Eigen::Vector3d met_C = range_tracker_.point(report_.range.range_m);
  const Eigen::Vector2d pixel = geometry_.project(met_C);
  const bool is_valid = report_.lidar_range_valid && geometry_.contains(pixel) &&
                        viewOfEnd(box_C, geometry_).contains(cv::Point2d(pixel.x(), pixel.y()));
  return is_valid ? geometry_.disparity(met_C.z()) : kNaN;
}

/// The verdict on a box, except for what belongs to the corridor, a query or a fan alone.
/// @param asked the conditions of FREE.  @param pair_reasons of the pair, which hold for every box.
/// @param recent_m so far it is free of obstacles of the last moments that images may miss.
Verdict Pipeline::judge(const Box& box_C, const BoxEvidence& shown, const CorridorConfig& asked,
                        std::uint32_t pair_reasons, const OccupiedCell& remembered, double recent_m) const {
  Verdict verdict;
  verdict.stamp_s = report_.verdict.stamp_s;
  verdict.reasons = pair_reasons | reasonsOf(shown, asked, verdict.clear_distance_m);
  verdict.unknown_fraction = shown.unobserved.fraction;
  if (const auto end = beamEndIn(box_C)) verdict.block(kShortRange, end->along_m);
  verdict.block(kOccupiedCell, remembered.clear_distance_m);
  verdict.state = stateOf(verdict.reasons);
  if (verdict.state != State::Blocked && recent_m < kInfinity) verdict.withhold(kRecentlyBlocked);
  verdict.free_distance_m = std::min(recent_m, freeDistance(verdict, shown, asked, box_C));
  return verdict;
}

/// By the corridor's rule: each box begins at the UAV.
std::vector<Verdict> Pipeline::judge(const Fan& fan_C, BoxInspector& inspector, std::uint32_t pair_reasons) {
  std::vector<double> lidar_px;
  for (int i = 0; i < fan_C.size(); ++i) lidar_px.push_back(lidarDisparity(fan_C.box(i)));
  const CorridorConfig& corridor = config_.corridor;
  const double smallest_m = smallestInspected(corridor);
  const std::vector<double> recent_m = recent_.freeUpTo(fan_C, smallest_m);
  const std::vector<BoxEvidence>& shown =
      inspector.inspect(fan_C, evidence(), corridor, lidar_px, disparity_estimator_.workers());
  std::vector<Verdict> verdicts;
  std::vector<Eigen::Vector3d> unshown_C;  // what blocks a box and no patch shows
  for (int i = 0; i < fan_C.size(); ++i) {
    const Box box_C = fan_C.box(i);
    const OccupiedCell occupied = remembered(box_C);
    const double known_m = mayHoldLostObstacle(box_C) ? 0.0 : recent_m[i];
    verdicts.push_back(judge(box_C, shown[i], corridor, pair_reasons, occupied, known_m));
    if (verdicts[i].state != State::Blocked || isShown(verdicts[i], shown[i].patches, smallest_m)) continue;
    if (const auto end = beamEndIn(box_C)) unshown_C.push_back(end->at_C);
    if (occupied.clear_distance_m < kInfinity) unshown_C.push_back(occupied.centre);
  }
  const bool is_corridor = &inspector == &inspector_;
  if (is_corridor && verdicts.front().state == State::Blocked) recent_.onBlocked();
  recent_.add(inspector.missable(), unshown_C, is_corridor);
  return verdicts;
}

/// A box that is no way is asked about from near the camera on, and more of it has to be known.
Verdict Pipeline::query(const Box& box) const {
  throwIfBroken(check(box, config_.map.resolution_m), "impossible box");
  if (std::isnan(report_.verdict.stamp_s) || depth_m_.empty()) {
    Verdict nothing;
    nothing.stamp_s = report_.verdict.stamp_s;
    nothing.clear_distance_m = kInfinity;
    nothing.reasons = (report_.verdict.reasons & kMapInDoubt) | kNoData;
    return nothing;
  }
  const Box box_C{T_M_C_.inverse() * box.T_M_F, box.size_m};
  const bool is_way = beginsAtUav(box_C);
  CorridorConfig asked = config_.corridor;
  if (!is_way) asked.blind_m = kNearestAsked_m, asked.max_unknown_fraction = kMostUnknown;
  const BoxEvidence& shown =
      query_inspector_.inspect(box_C, evidence(), asked, {lidarDisparity(box_C)}, disparity_estimator_.workers())
          .front();
  const double recent_m = mayHoldLostObstacle(box_C) ? 0.0 : recent_.freeUpTo(box_C, smallestInspected(asked)).front();
  const double unmapped = remembers() || is_cleared_ ? unknownFraction(map_.tree(), box) : 1.0;
  Verdict verdict = judge(box_C, shown, asked, report_.verdict.reasons & kMapInDoubt, remembered(box_C), recent_m);
  double unknown = unknownShare(box_C, shown.unobserved);
  if (!is_way) verdict.unknown_fraction = unknown;
  if (is_cleared_) {
    unknown = std::max(unknown, unmapped);
    verdict.unknown_fraction = std::max(verdict.unknown_fraction, unknown);
  } else if (remembers()) {
    unknown = std::min(unknown, unmapped);
  }
  if (remembers()) verdict.unknown_fraction = std::min(verdict.unknown_fraction, unknown);
  if ((!is_way || is_cleared_) && unknown > kMostUnknown) verdict.withhold(kUnobserved);
  if (remembers() && unknown <= kMostUnknown && !shown.unobserved.hasHole()) {  // memory says the rest
    verdict.reasons &= ~kUnobserved;
    verdict.state = stateOf(verdict.reasons);
    verdict.free_distance_m = std::min(recent_m, freeDistance(verdict, shown, asked, box_C));
  }
  if (is_way) verdict.limit(movers_.freeUpTo(box_C, config_.speed));
  return verdict;
}

std::vector<Verdict> Pipeline::judge(const Fan& fan_C) {
  if (depth_m_.empty()) {
    Verdict nothing;
    nothing.reasons = kNoData;
    return std::vector<Verdict>(fan_C.size(), nothing);
  }
  std::vector<Verdict> verdicts = judge(fan_C, fan_inspector_, report_.verdict.reasons & kMapInDoubt);
  for (Verdict& verdict : verdicts) {
    if (is_cleared_) verdict.withhold(kUnobserved);
  }
  return verdicts;
}

const AreaGrid& Pipeline::freeAreas(const std::optional<Eigen::Vector3d>& goal_C) {
  const FreeAreasConfig& config = config_.free_areas;
  const Fan fan_C(boxInCamera(), gridAngles(config.yaw_rad, config.step_rad),
                  gridAngles(config.pitch_rad, config.step_rad));
  const std::vector<Verdict> verdicts = judge(fan_C);
  free_areas_ = areaGrid(config);
  for (int i = 0; i < fan_C.size(); ++i) {
    free_areas_.areas[i].verdict = verdicts[i];
    free_areas_.areas[i].verdict.limit(movers_.freeUpTo(fan_C.box(i), config_.speed));
  }
  const Eigen::Vector3d ahead_C = rig_.T_C_F.linear().col(0);
  free_areas_.best = bestArea(free_areas_, rig_.T_C_F.linear().transpose() * goal_C.value_or(ahead_C), config.step_rad);
  return free_areas_;
}

/// From the camera on, at the height of the corridor's start.
LevelScan Pipeline::levelScan(const Eigen::Matrix3d& R_C_H) {
  LevelScan scan = unknownScan(config_.free_areas.step_rad, config_.corridor.length_m);
  const double width_m = 2.0 * scan.max_range_m * std::tan(0.5 * scan.step_rad);
  const Box corridor_C = boxInCamera();
  Box ahead_C{Eigen::Isometry3d(R_C_H), {scan.max_range_m, width_m, corridor_C.size_m.z()}};
  ahead_C.T_M_F.translate(R_C_H.col(2).dot(corridor_C.T_M_F.translation()) * Eigen::Vector3d::UnitZ());
  const std::vector<Verdict> verdicts = judge({ahead_C, gridAngles(-scan.first_yaw_rad, scan.step_rad), {0.0}});
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    const Verdict& verdict = verdicts[i];
    if (verdict.state == State::Free) scan.range_m[i] = kInfinity;
    if (verdict.state == State::Blocked && verdict.free_distance_m > 0.0) scan.range_m[i] = verdict.free_distance_m;
  }
  return scan;
}

/// Whether it is a way that the UAV may take from its place, like the free areas: then it is judged like the corridor.
/// Its part out of view, beside the camera, was seen from farther away, or is at the UAV.
bool Pipeline::beginsAtUav(const Box& box_C) const {
  const CorridorConfig& corridor = config_.corridor;
  const Box ahead_C = boxInCamera();
  const Eigen::Vector3d away_C = box_C.T_M_F.translation() - ahead_C.T_M_F.translation();
  const Eigen::Vector3d axis_F = ahead_C.T_M_F.linear().transpose() * box_C.T_M_F.linear().col(0);
  const double half_step_rad = 0.5 * config_.free_areas.step_rad;
  return away_C.norm() <= 0.5 * corridor.width_m &&
         (box_C.size_m.tail<2>().array() <= ahead_C.size_m.tail<2>().array() + kTouch_m).all() &&
         std::abs(std::atan2(axis_F.y(), axis_F.x())) <= config_.free_areas.yaw_rad + half_step_rad &&
         std::abs(std::asin(std::clamp(axis_F.z(), -1.0, 1.0))) <= config_.free_areas.pitch_rad + half_step_rad;
}

/// Where the beam ends in a box, or may by one sigma: d_K < D_min of the paper, carried to the volume. While the
/// sensors disagree the nearer one rules.
std::optional<Pipeline::BeamEnd> Pipeline::beamEndIn(const Box& box_C) const {
  double range_m = report_.range.range_m, nearest_m = range_m - report_.range.sigma_m;
  if (report_.range.disagreement) {
    range_m = std::fmin(range_m, report_.range.disagreement->range_m);
    nearest_m = std::fmin(nearest_m, range_m);
  }
  if (!std::isfinite(nearest_m)) return std::nullopt;
  const double along_m = (box_C.T_M_F.inverse() * range_tracker_.point(range_m)).x();
  for (const double end_m : {range_m, nearest_m}) {
    const Eigen::Vector3d at_C = range_tracker_.point(end_m);
    if (contains(box_C, at_C)) return BeamEnd{at_C, std::clamp(along_m, 0.0, box_C.size_m.x())};
  }
  return std::nullopt;  // a large sigma reaches before the box
}

}  // namespace flight_corridor
