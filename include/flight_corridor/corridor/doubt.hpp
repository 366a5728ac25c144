#pragma once

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
  explicit Doubt(const StereoGeometry& geometry);

  /// @param evidence of the pair.  @param correction of its disparities.
  /// @param is_lidar_valid its range says how far a pattern behind the box is: its competitors are none.
  /// @param smallest_m edge of a square: a patch of its area is doubt enough.
  bool isIn(const BoxView& box, const DisparityEvidence& evidence, const ScaleCorrection& correction,
            bool is_lidar_valid, double smallest_m);

  /// CV_8UC1, 255: pixels that isIn() found last.
  cv::Mat image() const;

 private:
  void collect(const BoxView& box, const DisparityEvidence& evidence, const ScaleCorrection& correction,
               bool is_lidar_valid);
  bool holdsRepeated(double smallest_m2) const;
  bool holdsPatch(int place, const ScaleCorrection& correction, double smallest_m2);

  /// A pixel at one of its disparities.
  struct Candidate {
    int pixel, place;
  };

  StereoGeometry geometry_;
  double first_px_;
  std::vector<double> corrected_px_;    // a place
  std::vector<Candidate> candidates_;   // in the order of the pixels
  std::vector<double> repeated_m2_;     // of repeated matches that are in the box whichever of their places is right,
                                        // by the place of the match
  std::vector<int> begins_, by_place_;  // pixels, disparity by disparity
  std::vector<int> labels_;             // a pixel; -1: none
  std::vector<int> parents_, sizes_;    // a label
};

}  // namespace flight_corridor
