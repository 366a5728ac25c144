#pragma once

#include <algorithm>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/geometry/fan.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/range/scale_correction.hpp"
#include "flight_corridor/stereo/disparity_evidence.hpp"

namespace flight_corridor {

/// Whether something could stand in a box that the images match behind it: pixels whose set of disparities, or whose
/// distinct competitor, has one in the box; and repeated matches in it. A single pixel finds chance matches; what
/// counts is a patch of them at one disparity, as large as the smallest obstacle. One object, one thread.
class Doubt {
 public:
  /// What is to be known of a direction's box.
  struct Question {
    bool is_open = true;          ///< false: nothing.
    bool is_lidar_valid = false;  ///< Its range says how far a pattern behind the box is: its competitors are none.
  };

  explicit Doubt(const StereoGeometry& geometry);

  /// @param from_m depth from which on the boxes count.  @param evidence of the pair.
  /// @param correction of its disparities.  @param questions a direction.
  /// @param smallest_m edge of a square: a patch of its area is doubt enough.
  void find(const Fan& fan, double from_m, const DisparityEvidence& evidence, const ScaleCorrection& correction,
            const std::vector<Question>& questions, double smallest_m);

  /// Whether there was any in a direction's box.
  bool isIn(int direction) const { return directions_[direction].is_doubtful; }
  /// CV_8UC1, 255: pixels that may be in the first direction's box.
  cv::Mat image() const;

 private:
  /// A pixel at one of its disparities.
  struct Candidate {
    int pixel, place;
  };
  /// What may be in a direction's box.
  struct Direction {
    Eigen::Isometry3d T_D_C;  // into the box's frame
    Eigen::Vector3d size_m;
    std::vector<Candidate> candidates;  // in the order of the pixels
    bool is_doubtful = false;
    int looked_at = -1;               // last pixel that was looked at
    std::vector<double> repeated_m2;  // of repeated matches that are in the box whichever of their places is right,
                                      // by the place of the match

    void clear() {
      candidates.clear();
      looked_at = -1;
      is_doubtful = false;
      std::fill(repeated_m2.begin(), repeated_m2.end(), 0.0);
    }
  };
  /// A pixel whose match may not be the only one.
  struct Pixel;

  void prepare(const Fan& fan, double from_m, const DisparityEvidence& evidence, const ScaleCorrection& correction);
  void collect(const Fan& fan, const DisparityEvidence& evidence, const ScaleCorrection& correction,
               const std::vector<Question>& questions);
  void add(const Fan& fan, int direction, const Pixel& pixel, bool is_lidar_valid);
  void addSurrounded(Direction& box, const Pixel& pixel) const;
  /// Of one that is looked at, and what stands for it [px].
  double pixelArea() const { return looks_at_half_ ? 2.0 : 1.0; }
  bool isDoubtful(const Direction& direction, double smallest_m2);
  static bool holdsRepeated(const Direction& direction, double smallest_m2);
  bool holdsPatch(const Direction& direction, double smallest_m2);
  bool holdsPatchAt(int place, double smallest_m2);

  StereoGeometry geometry_;
  double first_px_;
  double from_px_ = 0.0, end_px_ = 0.0;  // disparities between which the boxes are
  std::vector<double> corrected_px_;     // a place
  bool looks_at_half_ = false;           // of the pixels, as on the black fields of a chessboard
  std::vector<Direction> directions_;
  std::vector<int> begins_, by_place_;  // pixels, disparity by disparity
  std::vector<int> labels_;             // a pixel; -1: none
  std::vector<int> parents_, sizes_;    // a label
};

}  // namespace flight_corridor
