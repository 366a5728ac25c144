#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor {

/// A patch of matches that reaches into a box, or stands close beside it.
struct BoxPatch {
  double in_box_m2 = 0.0;      ///< What it shows in the box, or so little beside it that it may be there.
  double in_middle_m2 = 0.0;   ///< ... farther from the box's sides and end than noise may move it.
  double around_m2 = 0.0;      ///< ... and as near to the box.
  double begin_m = kInfinity;  ///< Along the box's axis to where it begins in the box.
  int in_box_px = 0;           ///< Matches in the box.

  /// Half of the smallest obstacle is enough: the matcher loses its edges.
  bool blocks(double smallest_m2) const { return in_box_m2 > 0.0 && in_box_m2 >= 0.5 * smallest_m2; }
};

/// What the newest pair's matches show in a box: connected pieces of one surface, and where they begin, more exactly
/// than single matches are: planes are fitted to them. One object, one thread.
class BoxPatches {
 public:
  static constexpr double kBeside_m = 0.15;  ///< So far noise may move what stands at a box's side.

  explicit BoxPatches(const StereoGeometry& geometry);

  /// @param depth_m CV_32FC1 of geometry.size(), corrected, NaN = no match.  @param textured see Texture.
  /// @param nearest_m nothing nearer counts.
  /// @param smallest_m edge of the smallest obstacle: planes are fitted to no smaller pieces.
  /// @return all patches within kBeside_m of the box, valid until the next call.
  const std::vector<BoxPatch>& find(const Box& box_C, const cv::Mat& depth_m, const cv::Mat& textured, double nearest_m,
                                    double smallest_m);

 private:
  /// A match near the box.
  struct Point {
    int u, v;
    float disparity_px;
    float edge_m;  // of its pixel
    bool is_in_box, is_in_middle;
  };
  /// A plane in the image: disparity = a u + b v + c.
  struct Plane;

  void collect(const Box& box_C, const cv::Mat& depth_m, const cv::Mat& textured, double nearest_m);
  void label();
  double begin(const Box& box_C, Point* first, Point* end, const Plane& plane, double smallest_m) const;
  Plane fit(const Point* first, const Point* end) const;

  StereoGeometry geometry_;
  std::vector<Point> points_;             // in the order of the pixels
  std::vector<int> place_, place_above_;  // of a row's pixels in points_; -1: none
  std::vector<int> patch_;                // a point: another of the same patch, itself at the root; then the patch
  std::vector<BoxPatch> patches_;
  std::vector<std::vector<Point>> members_;  // in the box, a patch
};

}  // namespace flight_corridor
