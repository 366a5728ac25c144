#pragma once

#include <cmath>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/pipeline.hpp"
#include "flight_corridor/range/pending_readings.hpp"
#include "flight_corridor/range/range_fusion.hpp"
#include "flight_corridor/range/range_tracker.hpp"
#include "tools/csv.hpp"

namespace flight_corridor::bench {

/// The paper's window: the corridor's face at its end, D_min, about the optical axis, on the left image.
inline cv::Rect paperWindow(const CorridorConfig& corridor, const StereoGeometry& geometry) {
  const Eigen::Vector3d corner(corridor.width_m / 2, corridor.height_m / 2, corridor.length_m);
  const Eigen::Vector2d low = geometry.project({-corner.x(), -corner.y(), corner.z()}), high = geometry.project(corner);
  const cv::Rect area(cv::Point(cvRound(low.x()), cvRound(low.y())), cv::Point(cvRound(high.x()), cvRound(high.y())));
  return area & cv::Rect({}, geometry.size());
}

/// D_c: the mean depth in the window; without the pixels that have no disparity.  @return [m]; NaN if none has.
inline double meanDepth(const cv::Mat& disparity_px, const cv::Rect& window, const StereoGeometry& geometry) {
  double sum_m = 0.0;
  int count = 0;
  for (const float d_px : cv::Mat_<float>(disparity_px(window))) {
    if (!(d_px > 0.0F)) continue;
    sum_m += geometry.depth(d_px);
    ++count;
  }
  return count > 0 ? sum_m / count : kNaN;
}

/// What the paper makes of one pair.
struct PaperVerdict {
  double stereo_m = kNaN, lidar_m = kNaN, fused_m = kNaN;  ///< D_c, d_L, d_K; the LiDAR is taken to be the camera.
  State state = State::Unknown;                            ///< Free: d_K >= D_min. Unknown: there is no d_K yet.
};

/// The paper's rule, from filled disparities and the LiDAR's ranges on.
class PaperRule {
 public:
  PaperRule(const CorridorConfig& window, const LidarConfig& lidar, const FusionConfig& fusion)
      : window_(window), lidar_(lidar), fusion_config_(fusion), fusion_(fusion) {}

  /// It counts from the first pair that is not before it.
  void addRange(const RangeReading& reading) { ranges_.put(reading.stamp_s, reading); }

  /// @param disparity_px of the pair, CV_32FC1, filled.
  PaperVerdict judge(double stamp_s, const cv::Mat& disparity_px, const StereoGeometry& geometry) {
    for (const RangeReading& reading : ranges_.take(stamp_s)) {
      if (!isRange(reading, lidar_)) continue;
      fusion_.add(Sensor::Lidar, reading.stamp_s, reading.range_m, fusion_config_.lidar_variance_m2);
      newest_ = reading;
    }
    PaperVerdict verdict;
    if (stamp_s - newest_.stamp_s <= fusion_config_.max_gap_s) verdict.lidar_m = newest_.range_m;
    verdict.stereo_m = meanDepth(disparity_px, paperWindow(window_, geometry), geometry);
    fusion_.add(Sensor::Stereo, stamp_s, verdict.stereo_m, fusion_config_.stereo_variance_m2);  // NaN is refused
    verdict.fused_m = fusion_.at(stamp_s).range_m;
    if (std::isnan(verdict.fused_m)) return verdict;
    verdict.state = verdict.fused_m >= window_.length_m ? State::Free : State::Blocked;
    return verdict;
  }

 private:
  CorridorConfig window_;
  LidarConfig lidar_;
  FusionConfig fusion_config_;
  RangeFusion fusion_;
  PendingReadings<RangeReading> ranges_;
  RangeReading newest_;  // of those used
};

/// Both on one pair, as two columns. Left the paper's figures: the window on the left image, and below it on the filled
/// depth; green free, red blocked, amber unknown; d_K, D_c and d_L as text. Right the overlay, and below it the depth.
/// @param pipeline, report of the pair.  @param disparity_px, paper of the same pair.
cv::Mat drawBoth(const Pipeline& pipeline, const Report& report, const cv::Mat& disparity_px,
                 const PaperVerdict& paper);

/// Adds a strip at the lower edge of a picture: whose verdicts, and these so far, of a recording of that many pairs.
void addStrip(const std::string& name, const std::vector<tools::ResultRow>& rows, std::size_t pairs, cv::Mat& picture);

}  // namespace flight_corridor::bench
