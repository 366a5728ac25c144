#pragma once

#include <array>
#include <cstdint>

#include "flight_corridor/stereo/aligned_bytes.hpp"

namespace flight_corridor {

/// Penalties of the smoothness term (Hirschmueller 2008, eq. 13), in bits of the census code.
constexpr std::uint8_t kSmallStepPenalty = 4;   ///< P1, a change of disparity by one: a quarter of the bits.
constexpr std::uint8_t kLargeStepPenalty = 20;  ///< P2, a larger one: above the worst cost, so that noise makes none.
constexpr std::uint8_t kEdgeStepPenalty = 8;    ///< P2 where the grey value steps: half the bits, what chance costs.
constexpr std::uint8_t kEdge_grey = 10;         ///< A larger step between neighbours is no shading: some 3 to 5 sigma.

/// Semi-global aggregation (Hirschmueller 2008, eq. 13 and 14) along five paths, from the left, right, above, above
/// left and above right, in one sweep from the first row to the last: L(p, d) = C(p, d) + min(L(q, d), L(q, d -+ 1) +
/// P1, min_i L(q, i) + P2) - min_i L(q, i), q the pixel before p; S = sum of L. With costs up to 16, L is at most 36
/// and S 180: 8 bits hold them. One object, one thread; no memory is allocated after construction.
class PathAggregation {
 public:
  /// @param stored_disparities a multiple of kDisparityStep.
  PathAggregation(int width_px, int stored_disparities);

  /// Forgets all rows: the next one is a first one.
  void restart();

  /// Takes the next row.
  /// @param costs as of CensusCosts.  @param grey the left image's row.
  /// @param sums refilled: S, as costs; aligned. Null: only the paths from above are taken on.
  void add(const std::uint8_t* costs, const std::uint8_t* grey, std::uint8_t* sums);

 private:
  void takePenalties(const std::uint8_t* grey);

  int width_px_, stored_, row_ = 0;
  AlignedBytes above_, above_left_, above_right_;  // L of the row before, less its minimum; the oblique ones lie at the
                                                   // place of their first pixel, so that each is updated where it is
  AlignedBytes grey_, grey_above_;                 // the row and the one before
  AlignedBytes level_;                             // P2 by pixel, of the step from the left
  std::array<AlignedBytes, 3> from_above_;         // and of those from above, above left and above right
};

}  // namespace flight_corridor
