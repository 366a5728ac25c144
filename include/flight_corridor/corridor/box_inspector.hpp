#pragma once

#include <vector>

#include "flight_corridor/band_workers.hpp"
#include "flight_corridor/corridor/bar_gaps.hpp"
#include "flight_corridor/corridor/box_patches.hpp"
#include "flight_corridor/corridor/clear_rays.hpp"
#include "flight_corridor/corridor/corridor.hpp"
#include "flight_corridor/corridor/doubt.hpp"
#include "flight_corridor/corridor/holes.hpp"
#include "flight_corridor/corridor/railing.hpp"
#include "flight_corridor/geometry/fan.hpp"

namespace flight_corridor {

/// The evidence of one stereo pair, for any box; views.
struct PairEvidence {
  const StereoFrame& images;
  const DisparityEvidence& disparity;
  const cv::Mat& depth_m;   ///< CV_32FC1, corrected, NaN = no match.
  const cv::Mat& textured;  ///< CV_8UC1, see Texture.
  const ClearRays& rays;
  const BarGaps& gaps;
  const EarlierPairs& earlier;            ///< What earlier pairs saw clear, from where the camera is now.
  const EarlierMatches& earlier_matches;  ///< What earlier pairs did not contradict, likewise.
  const ScaleCorrection& correction;
  double nearest_m;  ///< Nothing nearer is matched; not corrected.
};

/// The evidence of a pair about a box.
struct BoxEvidence {
  std::vector<BoxPatch> patches;  ///< In it and close beside it.
  Unobserved unobserved;
  bool is_ambiguous = false;       ///< Matches behind it fit in it as well.
  bool is_doubt_searched = false;  ///< Otherwise that is not known.
};

/// Judges boxes by one pair: presence, absence and doubt, each by patches as large as the smallest obstacle. One
/// object, one thread.
class BoxInspector {
 public:
  explicit BoxInspector(const StereoGeometry& geometry);

  /// @param config from blind_m on the boxes must be seen; the smallest obstacle, and how much may be unknown.
  /// @param lidar_px per direction: corrected disparity of the surface that the LiDAR measured in the view of the box's
  /// end; NaN: none.
  /// @return per direction; valid until the next call. If there are several, neither doubt is searched in boxes that
  /// have a hole nearer than they are wide and in which no patch blocks, nor patches beside a box.
  const std::vector<BoxEvidence>& inspect(const Fan& fan, const PairEvidence& pair, const CorridorConfig& config,
                                          const std::vector<double>& lidar_px, BandWorkers& workers);

  /// CV_8UC1: pixels that are matched behind the first direction's box, but fit in it as well, see Doubt::image().
  cv::Mat doubtful() const { return doubt_.image(); }
  /// Sighted of each pixel, CV_8UC1, in the first direction's box.  @param pair as of the last inspect().
  cv::Mat sighted(const PairEvidence& pair) const { return holes_.image(absenceOf(pair)); }
  /// The evidence of the first direction's box.
  const BoxEvidence& first() const { return evidence_.front(); }
  /// Points of the patches that block the first direction's box, in C [m].
  const std::vector<Eigen::Vector3d>& blocking() const { return patches_.blocking(); }
  /// Some points of the patches that block a direction's box and images may miss, see BoxPatches.
  const std::vector<PatchPoint>& missable() const { return patches_.missable(); }

 private:
  static Absence absenceOf(const PairEvidence& pair) {
    return {pair.rays, pair.disparity, pair.textured, pair.earlier};
  }

  StereoGeometry geometry_;
  BoxPatches patches_;
  Holes holes_;
  Doubt doubt_;
  Railings railings_;
  std::vector<Doubt::Question> questions_;
  std::vector<BoxEvidence> evidence_;
};

}  // namespace flight_corridor
