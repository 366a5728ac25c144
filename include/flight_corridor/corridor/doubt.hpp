#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/band_workers.hpp"
#include "flight_corridor/corridor/bit_patches.hpp"
#include "flight_corridor/geometry/fan.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/motion/earlier_matches.hpp"
#include "flight_corridor/range/scale_correction.hpp"
#include "flight_corridor/stereo/disparity_evidence.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Whether something could stand in a box that the images match behind it: pixels whose set of disparities, or whose
/// distinct competitor, has one in the box; and repeated matches in it. A single pixel finds chance matches; what
/// counts is a patch of them at one disparity, as large as the smallest obstacle. One object, one caller.
class Doubt {
 public:
  /// What is to be known of a direction's box.
  struct Question {
    bool is_open = true;     ///< false: nothing.
    double lidar_px = kNaN;  ///< Disparity of the surface that the LiDAR measured; NaN: none. What is matched there
                             ///< stands there: its competitors are none.
  };

  explicit Doubt(const StereoGeometry& geometry);

  /// @param from_m depth from which on the boxes count [m].  @param evidence of the pair.
  /// @param earlier pairs, as seen from now: what does not fit in them is no doubt.
  /// @param correction of the disparities.  @param questions a direction.
  /// @param workers of the caller, not at work: they do not nest.
  /// @param smallest_m edge of a square [m]: a patch of its area is doubt enough.
  void find(const Fan& fan, double from_m, const DisparityEvidence& evidence, const EarlierMatches& earlier,
            const ScaleCorrection& correction, const std::vector<Question>& questions, double smallest_m,
            BandWorkers& workers);

  /// Whether there was any in a direction's box.
  bool isIn(int direction) const { return directions_[direction].is_doubtful; }
  /// CV_8UC1: pixels that may be in the box, of a fan of one. 255: they are of a patch that is doubt; 128: they are
  /// not.
  cv::Mat image() const;

 private:
  /// What may be in a direction's box.
  struct Direction {
    Eigen::Isometry3d T_D_C;
    Question question;
    bool is_doubtful = false;
    std::vector<double> repeated_m2;  // of repeated matches that are in the box whichever of their disparities is
                                      // right, by the index of the match

    bool isUndecided() const { return question.is_open && !is_doubtful; }
  };
  /// A pixel whose match may not be the only one.
  struct Pixel;
  /// Memory of one band: whichever threads work, it grows as the images demand and sums up in the same order.
  struct Scratch {
    std::vector<int> repeated;  // pixels
    struct Box {
      bool is_undecided;
      int pixels;                         // that may be in it, at the disparity that is looked at
      std::vector<BitPatches::Run> runs;  // of these

      void clear() { pixels = 0, runs.clear(); }
      /// A pixel behind, or again, the last one.
      void add(int v, int u) {
        if (runs.empty() || runs.back().v != v || runs.back().end_u < u) runs.push_back({v, u, u});
        pixels += u + 1 - runs.back().end_u;
        runs.back().end_u = u + 1;
      }
    };
    std::vector<Box> boxes;               // a direction
    std::vector<std::uint64_t> box_bits;  // of one of them
    std::vector<cv::Point> doubtful;      // pixels of the last patch that is doubt
    BitPatches patches;
  };

  void prepare(const Fan& fan, double from_m, const DisparityEvidence& evidence, const ScaleCorrection& correction,
               const std::vector<Question>& questions);
  void prepare(Scratch& scratch) const;
  void findViews();
  void markRow(int v, const ScaleCorrection& correction, Scratch& scratch);
  void markPixel(int at, int first_d, const ScaleCorrection& correction, Scratch& scratch);
  void addRepeated(const Pixel& pixel);
  void checkDisparity(int d, double smallest_m2, Scratch& scratch) const;
  Pixel pixel(int at) const;
  bool isAlternative(const Pixel& pixel, int d) const;
  bool isMatchIn(int direction, const Pixel& pixel) const;
  bool isConfirmed(int direction, const Pixel& pixel) const;
  bool mayBeIn(int direction, const Pixel& pixel, int d) const;
  template <class Visit>
  void visitBracketed(const Pixel& pixel, Scratch& scratch, Visit&& visit) const;
  Eigen::Vector3f point(const Pixel& pixel, double disparity_px) const;
  std::ptrdiff_t begin(int v, int d) const;
  void mark(int d, int at);
  static bool holdsRepeated(const Direction& direction, double smallest_m2);
  bool holdsPatch(const Scratch::Box& box, int d, double smallest_px, Scratch& scratch) const;
  bool isRefuted(const std::vector<cv::Point>& patch, int d) const;

  StereoGeometry geometry_;
  double first_px_;
  Fan fan_{Box()};
  DisparityEvidence evidence_;
  const EarlierMatches* earlier_ = nullptr;      // of the present call
  const ScaleCorrection* correction_ = nullptr;  // likewise
  double from_px_ = 0.0, end_px_ = 0.0;          // disparities between which the boxes are
  bool is_camera_inside_ = false;                // all boxes: its rays enter none behind from_m
  std::vector<double> corrected_px_;             // a disparity
  int begin_d_ = 0, end_d_ = 0;                  // between which they are looked at
  std::vector<cv::Rect> views_;                  // of the boxes that are asked about, a disparity
  std::vector<double> matches_px_;               // a pixel, corrected; where it is looked at
  std::vector<std::uint64_t> bits_;  // pixels that may be in a box: row by row, and of a row disparity by disparity
  std::vector<Direction> directions_;
  std::vector<Scratch> scratch_;  // a band
};

}  // namespace flight_corridor
