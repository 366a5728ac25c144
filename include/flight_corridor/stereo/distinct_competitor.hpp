#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "flight_corridor/stereo/aligned_bytes.hpp"

namespace flight_corridor {

/// A row's competitors, by the disparity's index.
struct CompetitorRow {
  std::uint8_t* farthest;  ///< Smallest index of a competitor; untouched where there is none.
  std::uint8_t* nearest;   ///< Its largest; untouched where there is none.
  std::uint8_t* flags;     ///< kCompetitor and kDistinct are added.
};

/// Secondary minima of the cost in a small window, as good as the winner's and separated from it by a barrier: a
/// repeated pattern. And whether that window's costs distinguish the winner from most disparities at all: those of a
/// flat surface, or of noise, do not. Both are looked for in the matching costs, since smoothing makes certainty of a
/// tie, or of nothing. One object, one thread; no memory is allocated after construction.
class DistinctCompetitor {
 public:
  static constexpr int kReach_px = 3;           ///< The window is 7 x 3: flat, as the census's.
  static constexpr std::uint8_t kAsGood = 3;    ///< 0.3 bits a pixel, of the 21, halved.
  static constexpr std::uint8_t kBarrier = 31;  ///< 3 bits a pixel, of the 21, halved.
  static constexpr std::uint8_t kWorse = 10;    ///< 1 bit a pixel, of the 21, halved: a flat surface has less.

  DistinctCompetitor(int width_px, int min_disparity_px, int num_disparities);

  /// @param costs of the rows above, at and below, as of CensusCosts.  @param winner index of the row's best matches.
  void find(const std::array<const std::uint8_t*, 3>& costs, const std::uint8_t* winner, const CompetitorRow& out);

 private:
  template <int kWords>
  void judge(const std::uint8_t* winners, const CompetitorRow& out) const;

  int width_px_, min_disparity_px_, num_disparities_, words_;
  AlignedBytes columns_;                                  // sums of three costs, halved
  std::vector<std::uint64_t> as_good_, barrier_, worse_;  // words_ a pixel: what the window says of each disparity
};

}  // namespace flight_corridor
