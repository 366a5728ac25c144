#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "flight_corridor/config.hpp"
#include "flight_corridor/corridor/box_inspector.hpp"
#include "flight_corridor/corridor/clear_rays.hpp"
#include "flight_corridor/corridor/corridor.hpp"
#include "flight_corridor/corridor/free_areas.hpp"
#include "flight_corridor/corridor/movers.hpp"
#include "flight_corridor/corridor/recent_obstacles.hpp"
#include "flight_corridor/corridor/verdict.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/image_watch.hpp"
#include "flight_corridor/map/box_cells.hpp"
#include "flight_corridor/map/obstacle_memory.hpp"
#include "flight_corridor/map/occupancy_map.hpp"
#include "flight_corridor/motion/camera_motion.hpp"
#include "flight_corridor/motion/earlier_matches.hpp"
#include "flight_corridor/motion/earlier_pairs.hpp"
#include "flight_corridor/range/range_tracker.hpp"
#include "flight_corridor/stereo/disparity_estimator.hpp"
#include "flight_corridor/stereo/own_parts.hpp"
#include "flight_corridor/stereo/rectification_watch.hpp"
#include "flight_corridor/stereo/texture.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Durations of one pair's stages, by a steady clock.
struct StageTimes {
  double stereo_ms = 0, fusion_ms = 0, cloud_ms = 0, map_ms = 0, corridor_ms = 0, total_ms = 0;
};

/// Poses of the rig, and what of the UAV its left camera sees.
struct Rig {
  std::optional<Eigen::Isometry3d> T_C_L;          ///< LiDAR (beam along +x); without it LiDAR readings are not used.
  Eigen::Isometry3d T_C_F = opticalFromForward();  ///< Initial frame of the corridor (x forward): pointAlong().
  OwnParts own_parts{};
};

/// The whole result of one stereo pair.
struct Report : TrackedRange {
  Verdict verdict;
  RowAgreement rows;    ///< If it has a fault, the verdict is BAD_CALIBRATION.
  bool clears = false;  ///< The free space of this pair is trusted: it went into the map.
  StageTimes times;
};

/// Counts since construction, for diagnostics.
struct Counters : RangeCounts {
  std::uint64_t frames = 0, frames_refused = 0;
};

/// Stereo pairs and LiDAR ranges in, corridor verdicts out. One object, one caller at a time; in flight nothing throws.
class Pipeline {
 public:
  /// @param make_device_matcher of stereo/device "gpu" or "auto"; empty: all pairs are matched on the CPU.
  /// @throws std::invalid_argument with every broken rule of the config or the rig, if stereo sees nothing before the
  /// corridor's last quarter, or if the mask of own parts does not fit.
  Pipeline(const Config& config, const StereoGeometry& geometry, const Rig& rig,
           const DeviceMatcherFactory& make_device_matcher = {});

  /// A LiDAR reading, at its own stamp; may come late (fusion/buffer_s). It counts from the first pair that is not
  /// before it.
  void addRange(const RangeReading& reading) { range_tracker_.addRange(reading); }

  /// The rig's own acceleration, gravity removed, in C; at its own stamp, may come late like a range.
  void addAcceleration(double stamp_s, const Eigen::Vector3d& acceleration_C_mps2) {
    range_tracker_.addAcceleration(stamp_s, acceleration_C_mps2);
  }

  /// Sets the LiDAR's pose, or that there is no LiDAR: RangeTracker::mount().
  /// @throws std::invalid_argument if its beam does not point ahead.
  void mountLidar(const std::optional<Eigen::Isometry3d>& T_C_L) { range_tracker_.mount(T_C_L); }

  /// The verdict for one stereo pair. A pair with an earlier stamp than the last is refused (NO_DATA): if the clock was
  /// set back, make a new pipeline.
  /// @param T_W_C pose of the left camera in a fixed frame at the frame's stamp: that of the map if map/frame_id is
  /// set, which then needs it; else any, by which earlier pairs are remembered. Absent: their motion is told by the
  /// images.
  /// @return valid until the next call.
  const Report& process(const StereoFrame& frame, const std::optional<Eigen::Isometry3d>& T_W_C = std::nullopt);

  /// The verdict on any box, by the corridor's rule. If the box does not begin at the UAV, the part out of view is not
  /// excused, unless a map in a fixed frame knows it. The answer has the last frame's stamp: judge its age.
  /// @param box in the map's frame: map/frame_id, else C at the last frame.
  /// @throws std::invalid_argument with every broken rule of check(box).
  Verdict query(const Box& box) const;

  /// The free directions, by the corridor's rule and the last pair.
  /// @param goal_C wanted direction in C, of any length; absent: along the corridor.
  /// @return valid until the next call.
  const AreaGrid& freeAreas(const std::optional<Eigen::Vector3d>& goal_C = std::nullopt);

  /// The nearest obstacles in the view, where they are now, by the corridor's rule and the last pair.
  /// @param R_C_H turns vectors of a level frame, x along the heading, z up, into C.
  LevelScan levelScan(const Eigen::Matrix3d& R_C_H);

  /// Makes the cells of the map that meet a box unknown; in the map's frame.
  void clear(const Eigen::AlignedBox3d& box_M) {
    map();
    map_.clear(box_M);
    is_cleared_ = true;
    clearMemory(box_M);
  }

  /// Obstacles that stood in the corridor, which its box is tested against; in the frame of the camera's motion.
  ObstacleMemory& obstacles() { return obstacles_; }

  /// Points the corridor along +x of F from now on.
  void pointAlong(const Eigen::Isometry3d& T_C_F) { rig_.T_C_F = T_C_F; }

  /// Changes the corridor from now on; map, ranges and scale are kept.
  /// @throws std::invalid_argument like the constructor; then nothing has changed.
  void setCorridor(const CorridorConfig& corridor);

  /// Takes over from another rig's pipeline what does not depend on the rig: the newest images, and the time of the
  /// last obstacle.
  void takeOver(const Pipeline& before);

  /// As given, with the corridor of setCorridor().
  const Config& config() const { return config_; }
  const StereoGeometry& geometry() const { return geometry_; }
  const Counters& counters() const { return counters_; }
  /// Where pairs are matched.
  const MatchingDevice& matchingDevice() const { return disparity_estimator_.device(); }
  /// Stereo sees nothing nearer, by the learnt scale: that space stays unobserved [m].
  double nearestDepth() const;
  /// Whether stereo sees all space that corridor/blind_m does not excuse: then rays may be cleared from the camera on.
  bool seesFromBlind() const { return nearestDepth() <= config_.corridor.blind_m; }
  /// Products of the last processed frame.
  const Disparity& disparity() const { return disparity_; }
  /// The evidence: depth along z of C of the matches, CV_32FC1 [m], NaN = no match.
  const cv::Mat& depth() const { return depth_m_; }
  /// The same without matches on no texture, which are chance: what maps are made from.
  const cv::Mat& texturedDepth() const;
  /// CV_8UC1: pixels that are matched behind the corridor, but fit in it as well, see Doubt::image().
  cv::Mat doubtful() const { return inspector_.doubtful(); }
  /// Sighted of each pixel, CV_8UC1, in the corridor.
  cv::Mat sighted() const { return inspector_.sighted(evidence()); }
  /// The nearest hole in the corridor on the left image; empty: none.
  cv::Rect hole() const { return inspector_.first().unobserved.hole_px; }
  /// CV_8UC1, 255: pixels of the left image with texture, see Texture.
  const cv::Mat& textured() const { return left_texture_.mask(); }
  /// CV_8UC1; empty before the first frame.
  const cv::Mat& left() const { return pair_.left; }
  /// CV_8UC1, see coveredPixels(); empty: the UAV covers nothing of the left image.
  const cv::Mat& covered() const { return covered_; }
  /// The learnt scale and offset of the rig.
  const ScaleCorrection& scale() const { return range_tracker_.scale(); }
  /// Told motion against that of the images.
  const MotionWitness& motionWitness() const { return motion_.witness(); }
  /// In the map's frame M. Without map/frame_id it is built at the first call, from the last frame only.
  const OccupancyMap& map() const;
  /// Left camera in the map's frame at the last frame; identity without map/frame_id.
  const Eigen::Isometry3d& T_M_C() const { return T_M_C_; }
  /// The corridor's box in the map's frame, and in C.
  Box box() const { return corridorBox(config_.corridor, T_M_C_ * rig_.T_C_F); }
  Box boxInCamera() const { return corridorBox(config_.corridor, rig_.T_C_F); }

 private:
  std::uint32_t faults(const StereoFrame& frame, const std::optional<Eigen::Isometry3d>& T_W_C) const;
  const Report& refuse(std::uint32_t reasons);
  void findDepth();
  void trackRange();
  void rememberMatches();
  void remember();
  void followMotion(const std::optional<Eigen::Isometry3d>& told_W_C);
  void clearMemory(const Eigen::AlignedBox3d& box_M);
  void updateObstacles();
  void updateMap() const;
  void decide();
  PairEvidence evidence() const;
  Verdict judge(const Box& box_C, const BoxEvidence& shown, const CorridorConfig& asked, std::uint32_t pair_reasons,
                const OccupiedCell& remembered, double recent_m) const;
  std::vector<Verdict> judge(const Fan& fan_C, BoxInspector& inspector, std::uint32_t pair_reasons);
  std::vector<Verdict> judge(const Fan& fan_C);
  bool mayHoldLostObstacle(const Box& box_C) const;
  bool isTrusted() const;
  double lidarDisparity(const Box& box_C) const;
  struct BeamEnd {
    Eigen::Vector3d at_C;
    double along_m;  // the box's axis
  };
  std::optional<BeamEnd> beamEndIn(const Box& box_C) const;
  bool beginsAtUav(const Box& box_C) const;
  OccupiedCell remembered(const Box& box_C) const;
  bool remembers() const { return !config_.map.frame_id.empty(); }

  Config config_;
  StereoGeometry geometry_;
  Rig rig_;
  cv::Mat covered_;
  mutable DisparityEstimator disparity_estimator_;  // a query borrows its threads
  RangeTracker range_tracker_;
  mutable OccupancyMap map_;
  mutable bool is_map_current_ = true;  // it holds the last frame
  bool is_cleared_ = false;             // partly, since then
  Texture left_texture_, right_texture_;
  ClearRays rays_;
  BarGaps gaps_;
  BoxInspector inspector_;
  mutable BoxInspector query_inspector_;
  BoxInspector fan_inspector_;
  Movers movers_;
  RecentObstacles recent_;
  double newest_stamp_s_ = -kInfinity;
  ImageWatch images_;
  RectificationWatch rectification_;
  CameraMotion motion_;
  EarlierPairs earlier_;
  EarlierMatches earlier_matches_;
  ObstacleMemory obstacles_;                                     // in the frame of motion_'s present series
  Eigen::Isometry3d known_V_C_ = Eigen::Isometry3d::Identity();  // last known pose in that frame ...
  double known_s_ = kNaN;                                        // ... and its pair's stamp
  int series_ = 0;
  bool clears_ = false;             // the free space of the last pair that was judged is trusted
  bool keeps_matches_ = false;      // ... its matches may refute later doubt
  double judged_s_ = kNaN;          // ... its stamp
  std::uint32_t image_faults_ = 0;  // of the last pair
  StereoFrame pair_;                // own copies of the images: the caller may reuse its own
  Disparity disparity_;
  cv::Mat depth_m_;
  mutable cv::Mat textured_m_;
  Eigen::Isometry3d T_M_C_ = Eigen::Isometry3d::Identity();
  Report report_;
  AreaGrid free_areas_;
  Counters counters_;
};

}  // namespace flight_corridor
