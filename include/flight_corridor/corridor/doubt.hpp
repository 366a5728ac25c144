#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/geometry/box_view.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/range/scale_correction.hpp"
#include "flight_corridor/stereo/disparity_evidence.hpp"

namespace flight_corridor {

/// Whether something could stand in a box that the images match behind it: pixels whose set of disparities, or whose
/// distinct competitor, has one in the box; and repeated matches in it. A single pixel finds chance matches; what
/// counts is a patch of them at one disparity, as large as the smallest obstacle. One object, one thread.
class Doubt {
 public:
  /// @param smallest_obstacle_m edge of a square: a patch of its area is doubt enough.
  Doubt(const StereoGeometry& geometry, double smallest_obstacle_m);

  void setSmallestObstacle(double edge_m) { smallest_m2_ = edge_m * edge_m; }

  /// @param evidence of the pair.  @param correction of its disparities.
  /// @param is_lidar_valid its range says how far a pattern behind the box is: its competitors are none.
  bool isIn(const BoxView& box, const DisparityEvidence& evidence, const ScaleCorrection& correction,
            bool is_lidar_valid);

  /// CV_8UC1, 255: pixels that isIn() found last.
  cv::Mat image() const;

 private:
  void collect(const BoxView& box, const DisparityEvidence& evidence, const ScaleCorrection& correction,
               bool is_lidar_valid);
  bool holdsPatch(int place, const ScaleCorrection& correction);
  int root(int label);

  /// A pixel at one of its disparities.
  struct Candidate {
    int pixel, place;
  };

  StereoGeometry geometry_;
  double first_px_, smallest_m2_;
  std::vector<double> corrected_px_;    // a place
  std::vector<Candidate> candidates_;   // in the order of the pixels
  double repeated_m2_ = 0.0;            // of repeated matches that are in the box whichever of their places is right
  std::vector<int> begins_, by_place_;  // pixels, disparity by disparity
  std::vector<int> labels_;             // a pixel; -1: none
  std::vector<int> parents_, sizes_;    // a label
};

}  // namespace flight_corridor
