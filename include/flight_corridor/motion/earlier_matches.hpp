#pragma once

#include <opencv2/core/types.hpp>
#include <optional>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/motion/pair_ring.hpp"
#include "flight_corridor/range/scale_correction.hpp"
#include "flight_corridor/stereo/disparity_evidence.hpp"

namespace flight_corridor {

/// The disparities that earlier pairs did not contradict. What stands at a place fits there in every pair that shows
/// it; what fits in one by chance, of a pattern or of noise, hardly does in another. One object, one caller at a time.
class EarlierMatches {
 public:
  /// @param nearest_m nothing nearer is matched; not corrected.
  EarlierMatches(const StereoGeometry& geometry, double nearest_m);

  /// A pair's evidence; it is exchanged for buffers of an older pair.
  void add(double stamp_s, const CameraPose& pose, DisparityEvidence& matches);

  /// From now on places are asked about as seen from this pose.
  /// @param memory_s older pairs are forgotten.
  void moveTo(double stamp_s, const std::optional<CameraPose>& pose, double memory_s) {
    pairs_.moveTo(stamp_s, pose, memory_s);
  }

  void forget() { pairs_.forget(); }
  bool empty() const { return pairs_.views().empty(); }

  /// Whether an earlier pair shows that a patch of the newest one stands nowhere near a disparity: wherever the
  /// motion's error may move it (2 sigma), fewer than half of its pixels fit, or are hidden by what is nearer.
  /// @param patch pixels, not none.  @param at_px their disparity, corrected.  @param correction of all pairs.
  bool refute(const std::vector<cv::Point>& patch, double at_px, const ScaleCorrection& correction) const;

 private:
  using Ring = PairRing<DisparityEvidence>;
  struct Place {
    cv::Point pixel;
    double first_px, last_px;  // disparities that fit, as matched
  };

  bool refute(const Ring::View& view, const std::vector<cv::Point>& patch, double depth_m,
              const ScaleCorrection& correction) const;
  bool fits(const DisparityEvidence& matches, const Place& place, const cv::Point& moved_px) const;

  StereoGeometry geometry_;
  double first_px_, largest_px_;  // disparities between which matches are searched
  Ring pairs_;
};

}  // namespace flight_corridor
