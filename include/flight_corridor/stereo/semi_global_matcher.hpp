#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "flight_corridor/band_workers.hpp"

namespace flight_corridor {

/// Grey image of 8 bits as plain memory; a view.
struct GreyImage {
  const std::uint8_t* pixels = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  ///< Bytes from row to row.

  const std::uint8_t* row(int v) const { return pixels + v * stride; }
};

/// Images that a matcher is made for, and the disparities it searches.
struct MatcherSize {
  int width_px = 0;
  int height_px = 0;
  int min_disparity_px = 0;  ///< Of u_l - u_r; may be negative.
  int num_disparities = 0;   ///< A multiple of 32, up to kLargestDisparities.
  float offset_px = 0.0f;    ///< Excess of u_l - u_r: cx_l - cx_r.
};

/// Properties of a pixel's match: a bit set.
enum MatchFlag : std::uint8_t {
  kConsistent = 1u << 0,  ///< The right view's best match is the same, within kConsistent_px.
  kCompetitor = 1u << 1,  ///< Of a match: another disparity, a barrier away, fits a small window as well.
  kDistinct = 1u << 2,    ///< Consistent, and half of all disparities have clearly higher costs in its window.
  kRepeated = 1u << 3,    ///< Such a competitor lies farther away.
};

/// Output of a matcher: planes of width x height without gaps between the rows. Indices of disparities are those of the
/// bits: u_l - u_r less min_disparity_px.
struct MatchPlanes {
  float* best;      ///< Sub-pixel match [px], offset_px removed, of pixels with kDistinct; else NaN.
  float* repeated;  ///< Such a match with kRepeated, instead of in best.
  std::uint8_t *competitor_farthest, *competitor_nearest;  ///< Indices, where flags has kCompetitor.
  std::uint8_t* flags;                                     ///< Bits of MatchFlag.
  std::uint64_t* set;  ///< {d : S(d) <= min S + kContradiction}: bit d % 64 of word d / 64; whole words a pixel.
};

/// Semi-global matching (Hirschmueller 2008) that keeps for each pixel the best disparity and all that the images do
/// not contradict; matching_rules.hpp has the rules. Bands of rows are matched side by side; each begins some rows
/// before its first one, so that its paths are settled there. Bands depend on the image's height alone: the result does
/// not depend on the number of threads or the vector instructions. One object, one caller at a time; its memory is
/// reused.
class SemiGlobalMatcher {
 public:
  static constexpr int kBand_px = 120;  ///< Rows of a band: four at VGA, so that two to four cores share them evenly.
  static constexpr int kRunUp_px = 24;  ///< Rows before a band, for three paths only: one match in 400 shows the seams.

  /// @param workers must outlive it.
  /// @throws std::invalid_argument naming the impossible size.
  SemiGlobalMatcher(const MatcherSize& size, BandWorkers& workers);
  ~SemiGlobalMatcher();

  /// @param left, right rectified, of the constructor's size.  @param out refilled.
  void match(const GreyImage& left, const GreyImage& right, const MatchPlanes& out);

 private:
  struct Memory;

  MatcherSize size_;
  int bands_;
  BandWorkers& workers_;
  std::unique_ptr<Memory> memory_;
};

/// Bands of an image: about kBand_px rows each.
inline int bandsOf(int height_px) {
  constexpr int kBand_px = SemiGlobalMatcher::kBand_px;
  return height_px < kBand_px ? 1 : (height_px + kBand_px / 2) / kBand_px;
}

}  // namespace flight_corridor
