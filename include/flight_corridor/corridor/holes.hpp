#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

#include "flight_corridor/corridor/clear_rays.hpp"
#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/geometry/box_view.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/range/scale_correction.hpp"

namespace flight_corridor {

/// What the newest pair does not show clear of a box.
struct Unobserved {
  double hole_m = 0.0;           ///< Edge of the largest square across the view in which no ray is clear.
  cv::Rect hole_px;              ///< Where that is on the left image.
  double hole_depth_m = kNaN;    ///< ... and how far away.
  double first_hole_m = 0.0;  ///< Along the box's axis to the nearest one that could hide the smallest obstacle; +inf: none.
  double fraction = 1.0;         ///< Share of the box's volume without a clear ray, of what both cameras see [0..1].
  double out_of_view = 1.0;      ///< Share of the box's volume that they do not see [0..1].
  double too_near = 1.0;         ///< ... since stereo is blind there.
  double end_out_of_view = 1.0;  ///< ... of its last quarter.

  /// Whether somewhere in view the smallest obstacle could stand unseen.
  bool hasHole() const { return first_hole_m != kInfinity; }
};

/// Of the smallest obstacle's edge: of what is as large, half a census window more is lost. A smaller hole hides none.
constexpr double kHole = 1.6;

/// Looks for holes: places in a box, at any depth, in which an obstacle could stand unseen. Depths are sampled. One
/// object, one thread.
class Holes {
 public:
  explicit Holes(const StereoGeometry& geometry) : geometry_(geometry) {}

  /// @param from_m depth from which on the box must be seen.  @param nearest_m nothing nearer is matched: all of that
  /// is unclear, but no hole.  @param smallest_m edge of the smallest obstacle: holes are measured by a sixth of it,
  /// or to a pixel.
  Unobserved find(const Box& box_C, const BoxView& view, const ClearRays& rays, const ScaleCorrection& correction,
                  double from_m, double nearest_m, double smallest_m);

 private:
  struct Plane;
  void search(Plane& plane, const BoxView& view, const ClearRays& rays);

  StereoGeometry geometry_;
  std::vector<int> squares_, above_;  // edges of the squares that end at each column, of this row and the one above
};

}  // namespace flight_corridor
