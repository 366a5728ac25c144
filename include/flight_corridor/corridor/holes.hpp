#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/corridor/clear_rays.hpp"
#include "flight_corridor/geometry/fan.hpp"
#include "flight_corridor/geometry/section.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/motion/earlier_pairs.hpp"
#include "flight_corridor/range/scale_correction.hpp"
#include "flight_corridor/stereo/disparity_evidence.hpp"

namespace flight_corridor {

/// The part of a box that the newest pair does not show clear.
struct Unobserved {
  double hole_m = 0.0;           ///< Edge of the nearest square without a clear ray; 0: no square hides an obstacle.
  cv::Rect hole_px;              ///< Its place on the left image.
  double hole_depth_m = kNaN;    ///< Its depth.
  double hole_along_m = 0.0;     ///< Its distance along the box's axis; +inf: no hole.
  double fraction = 1.0;         ///< Share without a clear ray of the volume in view of both cameras [0..1].
  double unclear_along_m = 0.0;  ///< Distance along the box's axis to where that is more than may be; +inf: nowhere.
  double out_of_view = 1.0;      ///< Share of the box's volume out of their view [0..1].
  double too_near = 1.0;         ///< Share nearer than stereo sees.
  double end_out_of_view = 1.0;  ///< Share of its last quarter out of view.

  /// Whether the smallest obstacle could stand unseen somewhere in view.
  bool hasHole() const { return hole_along_m != kInfinity; }
};

constexpr double kEndShare = 0.25;  ///< Of a box's length: its end.

/// Times the smallest obstacle's edge: matches are lost half a census window around it. A smaller hole hides no
/// obstacle.
constexpr double kHole = 1.6;

/// What is known of a pixel's ray through a box, the least of all its depths: clear, clear in earlier pairs, not clear.
/// Nowhere: it does not meet the box where both cameras see it.
enum class Sighted : std::uint8_t { Nowhere, Clear, ClearBefore, Unclear };

/// What shows that space is clear; views.
struct Absence {
  const ClearRays& rays;             ///< Of the newest pair.
  const DisparityEvidence& matches;  ///< Of the newest pair: of a place at a match, or behind one, earlier pairs are
                                     ///< not asked.
  const cv::Mat& textured;  ///< See Texture.
  const EarlierPairs& earlier;
};

/// Looks for holes: places in a box, at any depth, in which an obstacle could stand unseen. Depths are sampled. One
/// object, one thread.
class Holes {
 public:
  explicit Holes(const StereoGeometry& geometry) : geometry_(geometry) {}

  /// @param from_m depth from which on the boxes must be seen.  @param nearest_m nothing nearer is matched: that space
  /// is unclear, but not a hole.  @param smallest_m edge of the smallest obstacle: holes are measured to a sixth of it,
  /// or to a pixel.  @param most_unclear share of the volume in view that may be without a clear ray.
  /// @return the unobserved part of each direction's box, valid until the next call.
  const std::vector<Unobserved>& find(const Fan& fan, const Absence& absence, const ScaleCorrection& correction,
                                      double from_m, double nearest_m, double smallest_m, double most_unclear);

  /// Sighted of each pixel, CV_8UC1, in the first direction's box.  @param absence as of the last find().
  cv::Mat image(const Absence& absence) const;

 private:
  /// A depth, and the sections of the boxes there.
  struct Plane {
    double depth_m = 0.0, thick_m = 0.0;  // of the slice at whose end it is
    int stride_px = 1;
    cv::Rect view;                  // around all sections
    std::vector<Section> sections;  // a direction
  };
  /// A plane in the last pair's disparities.
  struct Place {
    float at_px = 0.0f;           // corrected disparity
    float measured_px = 0.0f;     // as it is matched
    float first_px = 0.0f;        // smallest disparity searched
    int shift_px = 0;             // from a left pixel to the right one
    bool is_searched = false;     // not too near to be matched
    EarlierPairs::Plane earlier;  // as earlier pairs saw it
    cv::Mat unclear;              // CV_8UC1, strided: no ray shows that it is clear
    int edge = 1;                 // of a square that hides the smallest obstacle, in strides
  };
  /// Counts of a plane's pixels in one box.
  struct Look {
    int seen = 0, unclear = 0;
    bool may_hide = false;  // the smallest obstacle
  };
  /// The largest square.
  struct Square {
    int edge = 0, end_u = 0, end_v = 0;  // in strides; its last pixel
  };

  void layOut(const Fan& fan, double from_m, double smallest_m);
  void locate(const Plane& plane, const EarlierPairs& earlier, const ScaleCorrection& correction, double nearest_m,
              Place& place) const;
  static void findUnclear(int row, const Plane& plane, const Place& place, const Absence& absence,
                          std::uint8_t* unclear);
  static bool wasClear(int u, int v, const Place& place, const Absence& absence);
  void closeGaps(const Plane& plane, Place& place, const Absence& absence);
  void askEarlier(const Plane& plane, Place& place, const Absence& absence);
  void findUnclear(const Plane& plane, Place& place, const Absence& absence);
  Look look(const Plane& plane, const Section& section, const Place& place) const;
  Square search(const Plane& plane, const Place& place, int direction);
  /// A box's volume in a plane's slice.
  struct Volume;
  Volume volume(std::size_t plane, int direction) const;
  Unobserved measure(int direction, double most_unclear) const;
  double unclearFrom(int direction, double limit_m3) const;
  double beginOf(std::size_t plane, int direction) const;
  void findHole(int direction, Unobserved& found);

  StereoGeometry geometry_;
  Fan fan_{Box()};
  double from_m_ = kNaN, smallest_m_ = kNaN;
  std::vector<Plane> planes_;  // of fan_, the nearest first
  std::vector<Place> places_;  // a plane
  std::vector<Look> looks_;    // a plane and direction
  cv::Mat bare_, closed_;      // of the current plane, strided: without texture; the same, ended nearer, gaps closed
  cv::Mat hides_, in_squares_, unclear_sum_, hides_sum_;  // of the current plane, strided
  std::vector<int> squares_, above_;  // edges of the squares that end at each column, in this row and in the one above
  std::vector<Unobserved> found_;
};

}  // namespace flight_corridor
