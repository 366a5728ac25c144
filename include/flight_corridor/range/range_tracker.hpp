#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/range/beam_footprint.hpp"
#include "flight_corridor/range/lidar_watch.hpp"
#include "flight_corridor/range/pending_readings.hpp"
#include "flight_corridor/range/range_fusion.hpp"
#include "flight_corridor/range/scale_correction.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// The state of the beam at one stereo pair.
struct TrackedRange {
  RangeEstimate range;           ///< d_K at the pair's stamp.
  double range_lidar_m = kNaN;   ///< d_L: newest usable reading not after the pair, within fusion/max_gap_s.
  double range_stereo_m = kNaN;  ///< D_c: scale-corrected stereo range on the beam.
  /// d_K rests on the LiDAR: it is not slow, not in persistent disagreement, and a reading was believed within
  /// fusion/max_gap_s; all later ones were of farther surfaces.
  bool lidar_range_valid = false;
  bool lidar_is_new = false;  ///< Such a range is of this pair's moment: of what it shows.
  /// Persistently nearer than stereo, which does not show it beside the beam; or too close.
  bool lidar_is_nearer = false;
  bool lidar_is_slow = false;                 ///< It pauses three times its recent mean.
  bool lidar_is_rejected = false;             ///< Its newest reading was refused or gated.
  double scale = 1.0;                         ///< Depth after / before correction, at D_c (at 4 m without one).
  double scale_sigma = kNaN;                  ///< One sigma of it, from the rig's uncertainty.
  Outcome stereo_outcome = Outcome::Invalid;  ///< Outcome of D_c; Invalid without one.
};

/// Whether a reading is a range within the limits of its message and of the configuration.
bool isRange(const RangeReading& reading, const LidarConfig& config);

/// Outcomes of the LiDAR's readings and of stereo's, since construction.
struct RangeCounts {
  std::uint64_t lidar = 0;          ///< Readings whose pair has come.
  std::uint64_t lidar_invalid = 0;  ///< ... that are not within the limits, or came too late for the filter.
  std::uint64_t lidar_gated = 0;
  std::uint64_t stereo_gated = 0;
  std::uint64_t refused =
      0;  ///< Ranges and accelerations without a stamp, or too far from the pairs' (PendingReadings).
};

/// The range of the surface on the LiDAR's beam: d_K from the LiDAR's readings and from stereo's; and the rig's scale,
/// learnt from the two.
class RangeTracker {
 public:
  /// @param T_C_L LiDAR to left optical frame; without it readings are not used, and the beam is the camera's axis.
  /// @throws std::invalid_argument with every broken rule.
  RangeTracker(const LidarConfig& lidar, const FusionConfig& fusion, const ScaleConfig& scale,
               const StereoGeometry& geometry, const std::optional<Eigen::Isometry3d>& T_C_L);

  /// A LiDAR reading, at its own stamp; may come late (fusion/buffer_s). It counts from the first pair that is not
  /// before it.
  void addRange(const RangeReading& reading) { ranges_.put(reading.stamp_s, reading); }

  /// The rig's own acceleration, gravity removed, in C; at its own stamp, may come late like a range.
  void addAcceleration(double stamp_s, const Eigen::Vector3d& acceleration_C_mps2) {
    accelerations_.put(stamp_s, {stamp_s, acceleration_C_mps2});
  }

  /// Sets the LiDAR's pose, or that there is no LiDAR. If it comes or goes, the range is forgotten; the learnt scale is
  /// kept.
  /// @throws std::invalid_argument if its beam does not point ahead.
  void mount(const std::optional<Eigen::Isometry3d>& T_C_L);

  /// Fuses the readings up to a stereo pair, and the pair's own range on the beam.
  /// @param stamp_s not before the last one.
  TrackedRange update(double stamp_s, const cv::Mat& disparity_px);

  /// Point of C at a range along the beam [m].
  Eigen::Vector3d point(double range_m) const { return beam_.point(range_m); }
  const ScaleCorrection& scale() const { return scale_; }
  const RangeCounts& counts() const { return counts_; }

 private:
  struct Acceleration {
    double stamp_s;
    Eigen::Vector3d acceleration_C_mps2;
  };

  void fuseReadings(double stamp_s);
  void fuse(const RangeReading& reading);
  bool isShownBeside(double range_m, const cv::Mat& matched_px);
  double stereoVariance(const FootprintReading& stereo, const RangeEstimate& expected) const;
  void judge(double stamp_s, const std::optional<FootprintReading>& stereo, const RangeEstimate& expected,
             const cv::Mat& disparity_px, TrackedRange& tracked);
  double beyondRig(double stamp_s, const FootprintReading& stereo, const RangeEstimate& expected) const;
  double beyondRig(double expected_px, double disparity_px) const;
  void remember(double stamp_s, bool contradicts, bool agrees);
  double rigSigma(const FootprintReading& stereo) const;
  void learnScale(double stamp_s, const FootprintReading& stereo, const RangeEstimate& expected);
  double lidarRange(double stamp_s) const;

  LidarConfig lidar_config_;
  FusionConfig fusion_config_;
  ScaleConfig scale_config_;
  StereoGeometry geometry_;
  bool has_lidar_;
  BeamFootprint beam_;
  RangeFusion fusion_;
  ScaleCorrection scale_;
  LidarWatch lidar_;
  PendingReadings<RangeReading> ranges_;
  PendingReadings<Acceleration> accelerations_;
  RangeCounts counts_;
  double pair_stamp_s_ = kNaN;  // of the newest pair
  double contradiction_s_ =
      0.0;  // duration for which the LiDAR contradicted stereo, less that for which they agreed since
};

}  // namespace flight_corridor
