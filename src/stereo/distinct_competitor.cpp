#include "flight_corridor/stereo/distinct_competitor.hpp"

#include <algorithm>
#include <cstddef>

#include "flight_corridor/stereo/census.hpp"
#include "flight_corridor/stereo/cost_minima.hpp"
#include "flight_corridor/stereo/disparity_bits.hpp"
#include "stereo/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stereo/distinct_competitor.cpp"
#include <hwy/foreach_target.h>

#include "stereo/disparity_lanes-inl.hpp"

#ifndef FLIGHT_CORRIDOR_DISTINCT_COMPETITOR_ONCE
#define FLIGHT_CORRIDOR_DISTINCT_COMPETITOR_ONCE
namespace flight_corridor {
namespace {

struct WindowRow {
  int width_px, num_disparities;
  const std::uint8_t *above, *middle, *below, *winner;
  std::uint8_t* columns;
  std::uint64_t *as_good, *barrier, *worse;
};

constexpr int kColumns = 8;  // kept: those of a window and one more; a power of two

constexpr int kLargestWindow = (2 * DistinctCompetitor::kReach_px + 1) * (3 * kCensusBits / 2);
static_assert(kLargestWindow + std::max(DistinctCompetitor::kBarrier, DistinctCompetitor::kWorse) <= 255, "8 bits");

}  // namespace
}  // namespace flight_corridor
#endif

HWY_BEFORE_NAMESPACE();
namespace flight_corridor {
namespace HWY_NAMESPACE {
namespace {

/// Sum of a column's three costs, halved so that a window's fits into 8 bits.
template <int kVectors>
HWY_INLINE Curve<kVectors> column(const WindowRow& row, int u) {
  const Bytes bytes;
  const hn::RepartitionToWide<Bytes> words;
  const std::size_t at = static_cast<std::size_t>(u) * kVectors * kLanes;
  Curve<kVectors> sum;
  FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
    const std::size_t part = at + k * kLanes;
    const Vector whole = hn::Add(hn::Add(hn::Load(bytes, row.above + part), hn::Load(bytes, row.middle + part)),
                                 hn::Load(bytes, row.below + part));
    const Vector half = hn::BitCast(bytes, hn::ShiftRight<1>(hn::BitCast(words, whole)));
    sum.part[k] = hn::And(half, hn::Set(bytes, 127));
  }
  return sum;
}

template <int kVectors>
void windowsOf(const WindowRow& row) {
  constexpr int kStored = kVectors * kLanes, kWords = kStored / 64, kReach = DistinctCompetitor::kReach_px;
  const Bytes bytes;
  const int last_u = row.width_px - 1, last = row.num_disparities - 1;
  Curve<kVectors> window = filled<kVectors>(0);
  const auto place = [&](int u) { return row.columns + (u & (kColumns - 1)) * kStored; };
  for (int u = -kReach; u < kReach; ++u) {
    const Curve<kVectors> entering = column<kVectors>(row, std::clamp(u, 0, last_u));
    store(entering, place(u));
    FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
      window.part[k] = hn::Add(window.part[k], entering.part[k]);
    }
  }
  alignas(64) std::uint8_t costs[kStored];
  std::uint64_t *as_good = row.as_good, *barrier = row.barrier, *worse = row.worse;
  for (int u = 0; u < row.width_px; ++u, as_good += kWords, barrier += kWords, worse += kWords) {
    const Curve<kVectors> entering = column<kVectors>(row, std::min(u + kReach, last_u));
    store(entering, place(u + kReach));
    FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
      window.part[k] = hn::Add(window.part[k], entering.part[k]);
    }
    store(window, costs);
    const int winner = row.winner[u];
    const std::uint8_t best =
        std::min({costs[std::max(winner - 1, 0)], costs[winner], costs[std::min(winner + 1, last)]});
    const Vector good = hn::Set(bytes, static_cast<std::uint8_t>(best + DistinctCompetitor::kAsGood));
    const Vector bad = hn::Set(bytes, static_cast<std::uint8_t>(best + DistinctCompetitor::kBarrier));
    const Vector distinct = hn::Set(bytes, static_cast<std::uint8_t>(best + DistinctCompetitor::kWorse));
    const Curve<kVectors> leaving = load<kVectors>(place(u - kReach));
    FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
      constexpr int kMaskBytes = kLanes / 8;
      hn::StoreMaskBits(bytes, atMost(window.part[k], good), reinterpret_cast<std::uint8_t*>(as_good) + k * kMaskBytes);
      hn::StoreMaskBits(bytes, atMost(bad, window.part[k]), reinterpret_cast<std::uint8_t*>(barrier) + k * kMaskBytes);
      hn::StoreMaskBits(bytes, atMost(distinct, window.part[k]),
                        reinterpret_cast<std::uint8_t*>(worse) + k * kMaskBytes);
      window.part[k] = hn::Sub(window.part[k], leaving.part[k]);
    }
  }
}

void windows(const WindowRow& row) {
  withWords(storedDisparities(row.num_disparities) / 64,
            [&row](auto words) { windowsOf<words * kVectorsOfWord>(row); });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace flight_corridor
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flight_corridor {

HWY_EXPORT(windows);

DistinctCompetitor::DistinctCompetitor(int width_px, int min_disparity_px, int num_disparities)
    : width_px_(width_px),
      min_disparity_px_(min_disparity_px),
      num_disparities_(num_disparities),
      words_(storedDisparities(num_disparities) / 64),
      columns_(kColumns * storedDisparities(num_disparities)),
      as_good_(static_cast<std::size_t>(width_px) * words_),
      barrier_(static_cast<std::size_t>(width_px) * words_),
      worse_(static_cast<std::size_t>(width_px) * words_) {}

void DistinctCompetitor::find(const std::array<const std::uint8_t*, 3>& costs, const std::uint8_t* winner,
                              const CompetitorRow& out) {
  HWY_DYNAMIC_DISPATCH(windows)
  ({width_px_, num_disparities_, costs[0], costs[1], costs[2], winner, columns_.data(), as_good_.data(),
    barrier_.data(), worse_.data()});
  withWords(words_, [&](auto words) { judge<words>(winner, out); });
}

/// Competitors lie beyond the first barrier on either side of the winner, where the right camera looks. Distinct is a
/// winner that at least half of the disparities are worse than whose whole window it sees.
template <int kWords>
void DistinctCompetitor::judge(const std::uint8_t* winners, const CompetitorRow& out) const {
  const std::uint64_t *as_good = as_good_.data(), *barrier = barrier_.data(), *worse = worse_.data();
  for (int u = 0; u < width_px_; ++u, as_good += kWords, barrier += kWords, worse += kWords) {
    const int winner = winners[u];
    const int first_seen = std::max(0, u - (width_px_ - 1) - min_disparity_px_);
    const int last_seen = std::min(num_disparities_ - 1, u - min_disparity_px_);
    const int first_whole = std::max(0, std::min(u + kReach_px - (width_px_ - 1), 0) - min_disparity_px_);
    const int last_whole = std::min(num_disparities_ - 1, std::max(u - kReach_px, 0) - min_disparity_px_);
    const int whole = last_whole - first_whole + 1;
    if (first_whole <= winner && winner <= last_whole &&
        2 * bitsBetween(worse, kWords, first_whole, last_whole) >= whole) {
      out.flags[u] |= kDistinct;
    }
    const int nearer = lastBitTo(as_good, kWords, last_seen), farther = firstBitFrom(as_good, kWords, first_seen);
    if (nearer < winner + 2 && farther > winner - 2) continue;  // no room for a barrier between
    const int upper = firstBitFrom(barrier, kWords, winner + 1), lower = lastBitTo(barrier, kWords, winner - 1);
    const bool is_nearer = nearer > upper, is_farther = farther < lower;
    if (!is_nearer && !is_farther) continue;
    out.flags[u] |= kCompetitor;
    out.nearest[u] = static_cast<std::uint8_t>(is_nearer ? nearer : lastBitTo(as_good, kWords, lower));
    out.farthest[u] = static_cast<std::uint8_t>(is_farther ? farther : firstBitFrom(as_good, kWords, upper));
  }
}

}  // namespace flight_corridor
#endif
