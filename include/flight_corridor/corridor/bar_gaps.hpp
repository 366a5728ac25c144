#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/corridor/box_patches.hpp"
#include "flight_corridor/geometry/fan.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/range/scale_correction.hpp"

namespace flight_corridor {

/// Gaps in upright bars: a stem or a pole that is matched before the sky and before the ground, but not before a wall
/// of its own grey, goes on between. One object, one thread.
class BarGaps {
 public:
  explicit BarGaps(const StereoGeometry& geometry) : geometry_(geometry) {}

  /// @param disparity_px a pair's matches, CV_32FC1 [px], NaN = no match.  @param textured see Texture: others are
  /// chance.  @param correction of these.  @param smallest_m edge of the smallest obstacle.
  void find(const cv::Mat& disparity_px, const cv::Mat& textured, const ScaleCorrection& correction, double smallest_m);

  /// How far each direction's box is free of them, along its axis [m]; +inf: to the end.
  std::vector<double> freeUpTo(const Fan& fan_C, double smallest_m) const;

 private:
  /// Neighbouring matches of a row, with what is farther on both sides.
  struct Run {
    int v, begin, end;
    float disparity_px;
    int piece;  // that it is part of
  };
  /// Runs one below the other.
  struct Piece {
    int first_v, last_v, rows = 0;
    std::vector<int> runs = {};
    double disparity_px = 0.0, width_px = 0.0;  // mean
    double first_u = 0.0, last_u = 0.0;         // middle of its first and of its last rows
  };

  void findRuns(const ScaleCorrection& correction, double smallest_m);
  void join();
  void measure(Piece& piece) const;
  const Piece* below(const Piece& piece) const;
  std::vector<PatchPoint> between(const Piece& above, const Piece& below, const ScaleCorrection& correction,
                                  double smallest_m) const;

  StereoGeometry geometry_;
  cv::Mat matches_px_;  // those with texture
  std::vector<Run> runs_;
  std::vector<std::size_t> rows_;  // where a row's runs begin
  std::vector<Piece> pieces_;
  std::vector<std::vector<PatchPoint>> gaps_C_;
};

}  // namespace flight_corridor
