// Evidence at each pixel from sums and costs: best match, set, competitors; compiled once for each of Highway's
// targets.
#if defined(FLIGHT_CORRIDOR_EVIDENCE_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef FLIGHT_CORRIDOR_EVIDENCE_INL_HPP
#undef FLIGHT_CORRIDOR_EVIDENCE_INL_HPP
#else
#define FLIGHT_CORRIDOR_EVIDENCE_INL_HPP
#endif

#include <algorithm>
#include <cstdlib>

#include "flight_corridor/stereo/disparity_bits.hpp"
#include "stereo/disparity_lanes-inl.hpp"
#include "stereo/row_matcher.hpp"

HWY_BEFORE_NAMESPACE();
namespace flight_corridor {
namespace HWY_NAMESPACE {
namespace {

/// The smallest sum of each right pixel that the curve at hand reaches, and the disparity it belongs to. The lane of
/// disparity d holds the right pixel u - d: from one left pixel to the next all move on by a lane.
template <int kVectors>
class RightView {
 public:
  HWY_INLINE RightView() : least_(filled<kVectors>(255)), winner_(filled<kVectors>(0)) {}

  HWY_INLINE void add(const Curve<kVectors>& sums) {
    FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
      const Vector index = hn::Iota(Bytes(), static_cast<std::uint8_t>(k * kLanes));
      const Vector least = hn::Min(sums.part[k], least_.part[k]);
      winner_.part[k] = hn::IfThenElse(hn::Eq(least, least_.part[k]), winner_.part[k], index);
      least_.part[k] = least;
    }
  }

  /// @param out winner of the pixel that leaves, in the last lane of a vector.
  HWY_INLINE void moveOn(std::uint8_t* out) {
    hn::StoreU(winner_.part[kVectors - 1], Bytes(), out);
    least_ = shiftedUp(least_, hn::Set(Bytes(), 255));
    winner_ = shiftedUp(winner_, hn::Zero(Bytes()));
  }

  HWY_INLINE const Curve<kVectors>& winner() const { return winner_; }

 private:
  Curve<kVectors> least_, winner_;
};

/// Minima of the sums at pixels [first_u, end_u) and, along the diagonals of the same sums, of the right view's pixels
/// (Hirschmueller 2008, sec. 2.3).
template <int kVectors>
HWY_NOINLINE void findMinima(RowMatcher& m, int v, int first_u, int end_u, RightView<kVectors>& view,
                             std::uint64_t* set) {
  constexpr int kStored = kVectors * kLanes, kWords = kStored / 64;
  const Bytes bytes;
  const RowMatcher::Found& found = m.found[v & 1];
  std::uint8_t *const winners = found.winner.get(), *const below = found.rise_below.get();
  std::uint8_t* const above = found.rise_above.get();
  std::uint8_t* const right = m.right_winner.get() + m.size.width_px + (kVectors - 1) * kLanes;
  const std::uint8_t* sums = m.sums.get() + static_cast<std::size_t>(first_u) * kStored;
  const int last = m.size.num_disparities - 1;
  set += static_cast<std::size_t>(first_u) * kWords;
  RightView<kVectors> right_view = view;
  for (int u = first_u; u < end_u; ++u, sums += kStored, set += kWords) {
    const Curve<kVectors> sum = load<kVectors>(sums);
    const Vector least = smallest(sum);
    const Vector limit = hn::SaturatedAdd(least, hn::Set(bytes, kContradiction));
    std::uint64_t is_least[kWords] = {}, in_set[kWords] = {};
    FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
      addBits(hn::Eq(sum.part[k], least), k, is_least);
      addBits(atMost(sum.part[k], limit), k, in_set);
    }
    std::copy_n(in_set, kWords, set);
    right_view.moveOn(right - u);
    right_view.add(sum);
    const int winner = firstBit(is_least, kWords);
    const int step = 0 < winner && winner < last;  // 0: the sums end there
    winners[u] = static_cast<std::uint8_t>(winner);
    below[u] = static_cast<std::uint8_t>(sums[winner - step] - sums[winner]);
    above[u] = static_cast<std::uint8_t>(sums[winner + step] - sums[winner]);
  }
  view = right_view;
}

/// Left pixel u and disparity d meet the right pixel whose winner lies at width - 1 - u + d.
template <int kVectors>
HWY_NOINLINE void compareViews(RowMatcher& m, int v, const RightView<kVectors>& right_view) {
  FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
    hn::StoreU(right_view.winner().part[k], Bytes(), m.right_winner.get() + k * kLanes);
  }
  RowMatcher::Found& found = m.found[v & 1];
  const int width = m.size.width_px;
  const std::uint8_t* right = m.right_winner.get() + width - 1;
  for (int u = 0; u < width; ++u) {
    const int winner = found.winner[u], u_right = u - winner - m.size.min_disparity_px;
    const bool seen = 0 <= u_right && u_right < width;
    found.flags[u] = seen && std::abs(right[winner - u] - winner) <= kConsistent_px ? kConsistent : 0;
  }
}

/// Sum of a column's three costs, halved so that a window's fits into 8 bits.
template <int kVectors>
HWY_INLINE Curve<kVectors> column(const std::array<const std::uint8_t*, 3>& costs, int u) {
  const Bytes bytes;
  Curve<kVectors> sum;
  FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
    const std::size_t at = static_cast<std::size_t>(u) * kVectors * kLanes + k * kLanes;
    const Vector two = hn::Add(hn::Load(bytes, costs[0] + at), hn::Load(bytes, costs[1] + at));
    sum.part[k] = hn::AverageRound(two, hn::Load(bytes, costs[2] + at));
  }
  return sum;
}

/// Costs in the window of each pixel of [first_u, end_u): a column enters, one leaves.
/// @param sum of the columns around first_u but the last one; of those around end_u afterwards.
template <int kVectors>
HWY_NOINLINE void moveWindow(RowMatcher& m, int v, int first_u, int end_u, Curve<kVectors>& sum) {
  constexpr std::size_t kStored = kVectors * kLanes;
  const std::array<const std::uint8_t*, 3> rows{m.costsOf(std::max(v - 1, 0)), m.costsOf(v),
                                                m.costsOf(std::min(v + 1, m.size.height_px - 1))};
  const int last_u = m.size.width_px - 1;
  const auto place = [columns = m.columns.get()](int u) { return columns + (u & (kColumns - 1)) * kStored; };
  Curve<kVectors> window = sum;
  const auto enter = [&](int u) HWY_ATTR {
    const Curve<kVectors> entering = column<kVectors>(rows, std::min(std::max(u, 0), last_u));
    store(entering, place(u));
    FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
      window.part[k] = hn::Add(window.part[k], entering.part[k]);
    }
  };
  for (int u = -kWindowReach_px; first_u == 0 && u < kWindowReach_px; ++u) enter(u);
  std::uint8_t* costs = m.windows.get();
  for (int u = first_u; u < end_u; ++u, costs += kStored) {
    enter(u + kWindowReach_px);
    store(window, costs);
    const Curve<kVectors> leaving = load<kVectors>(place(u - kWindowReach_px));
    FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
      window.part[k] = hn::Sub(window.part[k], leaving.part[k]);
    }
  }
  sum = window;
}

/// Consistent pixels' matches. Competitors lie beyond the first barrier on either side of the winner, in the right
/// camera's view. A winner is distinct if at least half of the disparities whose whole window the right camera sees are
/// clearly worse.
/// @param costs the windows', of a block.
template <int kVectors>
HWY_NOINLINE void judge(RowMatcher& m, int v, int first_u, int end_u, const std::uint8_t* costs, std::uint8_t* farthest,
                        std::uint8_t* nearest) {
  constexpr int kStored = kVectors * kLanes, kWords = kStored / 64;
  const Bytes bytes;
  const RowMatcher::Found& found = m.found[v & 1];
  const std::uint8_t* const winners = found.winner.get();
  std::uint8_t* const flags = found.flags.get();
  const std::uint64_t *seen = &m.seen[first_u * kWords], *whole = &m.whole[first_u * kWords];
  const int last = m.size.num_disparities - 1;
  for (int u = first_u; u < end_u; ++u, costs += kStored, seen += kWords, whole += kWords) {
    if (!(flags[u] & kConsistent)) continue;
    const int winner = winners[u];
    const std::uint8_t best =
        std::min({costs[std::max(winner - 1, 0)], costs[winner], costs[std::min(winner + 1, last)]});
    const Vector at_most = hn::Set(bytes, static_cast<std::uint8_t>(best + kAsGood));
    const Vector bad = hn::Set(bytes, static_cast<std::uint8_t>(best + kBarrier));
    const Vector clearly_worse = hn::Set(bytes, static_cast<std::uint8_t>(best + kClearlyWorse));
    std::uint64_t good[kWords] = {}, barrier[kWords] = {}, is_worse[kWords] = {};
    FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
      const Vector part = hn::Load(bytes, costs + k * kLanes);
      addBits(atMost(part, at_most), k, good);
      addBits(atMost(bad, part), k, barrier);
      addBits(atMost(clearly_worse, part), k, is_worse);
    }
    int worse = 0, all = 0;
    for (int k = 0; k < kWords; ++k) {
      worse += __builtin_popcountll(is_worse[k] & whole[k]);
      all += __builtin_popcountll(whole[k]);
      good[k] &= seen[k];
    }
    const bool sees = whole[winner / 64] >> winner % 64 & 1u;
    if (!sees || 2 * worse < all) continue;
    flags[u] |= kDistinct;
    if (lastBit(good, kWords) < winner + 2 && firstBit(good, kWords) > winner - 2) continue;  // no room for a barrier
    const int upper = firstBitFrom(barrier, kWords, winner + 1), lower = lastBitTo(barrier, kWords, winner - 1);
    for (int k = 0; k < kWords; ++k) good[k] = bitsFrom(good[k], k, upper) | bitsTo(good[k], k, lower);
    const int last_good = lastBit(good, kWords);
    if (last_good < 0) continue;
    farthest[u] = static_cast<std::uint8_t>(firstBit(good, kWords));
    flags[u] |= farthest[u] < winner ? kCompetitor | kRepeated : kCompetitor;
    nearest[u] = static_cast<std::uint8_t>(last_good);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace flight_corridor
HWY_AFTER_NAMESPACE();

#endif
