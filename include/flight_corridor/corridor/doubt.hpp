#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/corridor/bit_patches.hpp"
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
  /// What may be in a direction's box.
  struct Direction {
    bool is_open = false, is_lidar_valid = false, is_doubtful = false;
    std::vector<double> repeated_m2;  // of repeated matches that are in the box whichever of their places is right,
                                      // by the place of the match
    std::vector<int> pixels;          // that may be in it, at the place that is looked at

    bool isAsked() const { return is_open && !is_doubtful; }
  };
  /// Between two opposite sides of each direction's box.
  struct Slabs {
    Eigen::Matrix<double, Eigen::Dynamic, 3> normals_C;
    Eigen::ArrayXd low_m, high_m;  // from the camera to the sides
  };
  /// A pixel whose match may not be the only one.
  struct Pixel;

  void prepare(const Fan& fan, double from_m, const DisparityEvidence& evidence, const ScaleCorrection& correction,
               const std::vector<Question>& questions);
  void findViews();
  void collect(const ScaleCorrection& correction);
  void collect(int at, int first_place, const ScaleCorrection& correction);
  void addRepeated(const Pixel& pixel);
  void lookAt(int place, double smallest_m2);
  Pixel pixel(int at) const;
  bool isAlternative(const Pixel& pixel, int place) const;
  bool isMatchIn(int direction, const Pixel& pixel) const;
  bool mayBeIn(int direction, const Pixel& pixel, int place) const;
  void cross(const Pixel& pixel);
  template <class Visit>
  void visitSurrounded(const Pixel& pixel, Visit&& visit);
  Eigen::Vector3f point(const Pixel& pixel, double disparity_px) const;
  std::ptrdiff_t begin(int v, int place) const;
  void set(int place, int at);
  static bool holdsRepeated(const Direction& direction, double smallest_m2);
  bool holdsPatch(const Direction& direction, double smallest_px);

  StereoGeometry geometry_;
  double first_px_;
  Fan fan_{Box()};
  DisparityEvidence evidence_;
  double from_px_ = 0.0, end_px_ = 0.0;   // disparities between which the boxes are
  std::vector<double> corrected_px_;      // a place
  int begin_place_ = 0, end_place_ = 0;   // between which they are looked at
  std::vector<cv::Rect> views_;           // of the boxes that are asked about, a place
  std::vector<double> matches_px_;        // a pixel, corrected; where it is looked at
  std::vector<std::uint64_t> bits_;       // pixels that may be in a box: row by row, and of a row place by place
  std::vector<std::uint64_t> direction_;  // ... in a direction's, at one place
  std::vector<Direction> directions_;
  std::array<Slabs, 3> slabs_;
  Eigen::ArrayXd per_m_, entries_, exits_;  // of a pixel's ray, a direction: see Crossing
  BitPatches patches_;
};

}  // namespace flight_corridor
