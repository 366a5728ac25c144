#pragma once

#include <cstdint>
#include <vector>

#include "flight_corridor/stereo/aligned_bytes.hpp"

namespace flight_corridor {

/// How far above its minimum the sum of five paths contradicts a disparity: half a code, or a tenth of a code a path.
constexpr std::uint8_t kContradiction = 8;
constexpr int kConsistent_px = 1;  ///< Both views' whole disparities may differ by rounding.

/// A row's answers, by the disparity's index: the smallest disparity searched is 0.
struct MinimaRow {
  std::uint8_t* winner;    ///< Of S; of equal ones the smallest.
  std::uint8_t* farthest;  ///< Smallest index of the set {d : S(d) <= min S + kContradiction}.
  std::uint8_t* nearest;   ///< Its largest.
  std::uint8_t* flags;     ///< Bits of MatchFlag.
  std::uint64_t* set;      ///< The set itself: bit d % 64 of word d / 64; storedDisparities() / 64 words a pixel.
};

/// What is known of a pixel's match: a bit set.
enum MatchFlag : std::uint8_t {
  kConsistent = 1u << 0,  ///< The right view's best match is the same, within kConsistent_px.
  kHidden = 1u << 1,      ///< It is not, for the right view shows something nearer there.
  kCompetitor = 1u << 2,  ///< Another disparity, a barrier away, fits a small window as well.
  kDistinct = 1u << 3,    ///< The costs of its own window are lower at its best disparity than at most others.
};

/// Minima of the sums over paths, of the left view's pixels and, along the diagonals of the same sums, of the right
/// view's (Hirschmueller 2008, sec. 2.3). One object, one thread; no memory is allocated after construction.
class CostMinima {
 public:
  CostMinima(int width_px, int min_disparity_px, int num_disparities);

  /// @param sums as of PathAggregation.  @param out refilled.
  void find(const std::uint8_t* sums, const MinimaRow& out);

 private:
  template <int kWords>
  void readBits(const MinimaRow& out) const;
  void compareViews(const MinimaRow& out) const;

  int width_px_, min_disparity_px_, words_;
  std::vector<std::uint64_t> least_;  // words_ a pixel: bits of the disparities whose sum is the minimum
  AlignedBytes right_;                // winners of the right view, from its last pixel to the first
};

}  // namespace flight_corridor
