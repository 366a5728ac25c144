#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "flight_corridor/band_workers.hpp"
#include "flight_corridor/stereo/census.hpp"
#include "flight_corridor/stereo/subpixel.hpp"

namespace flight_corridor {

/// Images that a matcher is made for, and the disparities it searches.
struct MatcherSize {
  int width_px = 0;
  int height_px = 0;
  int min_disparity_px = 0;  ///< Of u_l - u_r; may be negative.
  int num_disparities = 0;   ///< A multiple of 32, up to kLargestDisparities.
};

/// Where a matcher writes what it finds: planes of width x height without gaps between the rows. All disparities are
/// indices: u_l - u_r less min_disparity_px.
struct MatchPlanes {
  float* best;                       ///< Sub-pixel; NaN unless kConsistent, also where not kDistinct.
  std::uint8_t *farthest, *nearest;  ///< Bounds of the set of disparities that the images do not contradict.
  std::uint8_t *competitor_farthest, *competitor_nearest;  ///< Of the competitors, where flags has kCompetitor.
  std::uint8_t* flags;                                     ///< Bits of MatchFlag.
  std::uint64_t* set;  ///< The set: bit d % 64 of word d / 64; storedDisparities() / 64 words a pixel.
};

/// Semi-global matching (Hirschmueller 2008) that keeps its doubt: for each pixel the best disparity and all those that
/// the images do not contradict. Bands of rows are matched side by side; each begins some rows before its first one, so
/// that its paths are settled there. Bands depend on the image's height alone: the result does not depend on how many
/// threads, or which vector instructions, work on it.
/// One object, one caller at a time; no memory is allocated after construction.
class SemiGlobalMatcher {
 public:
  static constexpr int kBand_px = 120;  ///< Rows of a band: four at VGA, so that two to four cores share them evenly.
  static constexpr int kRunUp_px = 24;  ///< Rows before a band, of three paths only: P2 has been paid off by then.

  /// @param threads that work, the caller's included; 1 or more.
  /// @throws std::invalid_argument naming what is impossible of the size or the threads.
  SemiGlobalMatcher(const MatcherSize& size, int threads);
  ~SemiGlobalMatcher();

  /// @param left, right rectified, of the constructor's size.  @param out refilled.
  void match(const GreyImage& left, const GreyImage& right, const MatchPlanes& out);

  /// For further work on what was found.
  BandWorkers& workers() { return threads_; }

 private:
  struct Worker;

  MatcherSize size_;
  int bands_;
  SubpixelPlane subpixels_;
  std::vector<std::unique_ptr<Worker>> workers_;  // one a thread
  BandWorkers threads_;                           // last: nothing of the above goes before the threads do
};

}  // namespace flight_corridor
