#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/geometry/fan.hpp"
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
  /// Whether the next image may lose it, or noise move it out of the box.
  bool isMissable() const;
};

/// A match of a patch, and what it stands for of what the patch shows.
struct PatchPoint {
  Eigen::Vector3f at;  ///< [m]
  float shown_m2;
};

/// Shortens how far boxes are free to where points that together show an obstacle begin in them, along their axes.
/// @param T_F_P turns the points into the fan's frame.  @param smallest_m edge of the smallest obstacle.
/// @param free_m per direction [m].
void shorten(const Fan& fan, const Eigen::Isometry3f& T_F_P, const std::vector<PatchPoint>& points_P, double smallest_m,
             std::vector<double>& free_m);

/// What the newest pair's matches show in boxes: connected pieces of one surface, and where they begin, more exactly
/// than single matches are: planes are fitted to them. One object, one thread.
class BoxPatches {
 public:
  static constexpr double kBeside_m = 0.15;  ///< So far noise may move what stands at a box's side.

  explicit BoxPatches(const StereoGeometry& geometry);

  /// @param depth_m CV_32FC1 of geometry.size(), corrected, NaN = no match.  @param textured see Texture.
  /// @param nearest_m nothing nearer counts.
  /// @param smallest_m edge of the smallest obstacle: planes are fitted to no smaller pieces.
  /// @param beside_m up to so far beside a box patches are measured: kBeside_m, or 0 for what is in it alone.
  /// @return the patches of each direction's box, valid until the next call.
  const std::vector<std::vector<BoxPatch>>& find(const Fan& fan, const cv::Mat& depth_m, const cv::Mat& textured,
                                                 double nearest_m, double smallest_m, double beside_m = kBeside_m);

  /// Points of the patches that block the first direction's box, in C [m]; valid until the next call.
  const std::vector<Eigen::Vector3d>& blocking() const { return blocking_C_; }
  /// Some points of the patches that block a box and images may miss, in that box, in C; valid until the next call.
  const std::vector<PatchPoint>& missable() const { return missable_C_; }

 private:
  /// A match in or near a box.
  struct Point {
    int u, v;
    float disparity_px;
    float edge_m;           // of its pixel
    Eigen::Vector3f hit_F;  // as near as noise may have it
    float fitted_px;        // disparity on the plane
  };
  /// A plane in the image: disparity = a u + b v + c.
  struct Plane;

  void collect(const Fan& fan, const cv::Mat& depth_m, const cv::Mat& textured, double nearest_m);
  void label();
  void sort();
  void measure(const Fan& fan, const Point* first, const Point* end, double smallest_m, float beside_m);
  void keep(const Fan& fan, const Point* first, const Point* end);
  void keepMissable(const Fan& fan, const Point* first, const Point* end, double smallest_m);
  static void fitPlanes(Point* first, Point* end, const Plane& plane, double smallest_m);
  static Plane fit(const Point* first, const Point* end);

  StereoGeometry geometry_;
  std::vector<Point> points_, sorted_;    // in the order of the pixels; patch by patch
  std::vector<int> place_, place_above_;  // of a row's pixels in points_; -1: none
  std::vector<int> patch_, begins_;       // a point: another of the same patch, itself at the root; then the patch
  std::vector<BoxPatch> sums_;            // of one patch, a direction
  std::vector<std::vector<BoxPatch>> found_;
  std::vector<Eigen::Vector3d> blocking_C_;
  std::vector<PatchPoint> missable_C_;
};

}  // namespace flight_corridor
