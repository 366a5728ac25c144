#include "flight_corridor/stereo/cost_minima.hpp"

#include <cstddef>
#include <cstdlib>

#include "flight_corridor/stereo/census.hpp"
#include "flight_corridor/stereo/disparity_bits.hpp"
#include "stereo/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stereo/cost_minima.cpp"
#include <hwy/foreach_target.h>

#include "stereo/disparity_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace flight_corridor {
namespace HWY_NAMESPACE {
namespace {

/// The smallest sum of each right pixel that the curve at hand reaches, and the disparity it belongs to. The lane of
/// disparity d holds the right pixel u - d: from one left pixel to the next all move on by a lane.
template <int kVectors>
class RightView {
 public:
  HWY_INLINE RightView() : least_(filled<kVectors>(255)), winner_(filled<kVectors>(0)) {
    FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
      index_.part[k] = hn::Iota(Bytes(), static_cast<std::uint8_t>(k * kLanes));
    }
  }

  HWY_INLINE void add(const Curve<kVectors>& sums) {
    FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
      const Vector least = hn::Min(sums.part[k], least_.part[k]);
      winner_.part[k] = hn::IfThenElse(hn::Eq(least, least_.part[k]), winner_.part[k], index_.part[k]);
      least_.part[k] = least;
    }
  }

  HWY_INLINE void moveOn() {
    least_ = shiftedUp(least_, hn::Set(Bytes(), 255));
    winner_ = shiftedUp(winner_, hn::Zero(Bytes()));
  }

  HWY_INLINE Vector last() const { return winner_.part[kVectors - 1]; }
  HWY_INLINE const Curve<kVectors>& winner() const { return winner_; }

 private:
  Curve<kVectors> least_, winner_, index_;
};

/// @param least, set refilled: bits of the disparities with the smallest sum, and of those that are hardly above.
/// @param right refilled: winner of each right pixel, the last pixel first.
template <int kVectors>
void minimaOf(const std::uint8_t* sums, int width_px, std::uint64_t* least, std::uint64_t* set, std::uint8_t* right) {
  const Bytes bytes;
  constexpr int kWords = kVectors * kLanes / 64;
  RightView<kVectors> right_view;
  for (int u = 0; u < width_px; ++u, sums += kVectors * kLanes, least += kWords, set += kWords) {
    const Curve<kVectors> sum = load<kVectors>(sums);
    const Vector smallest_sum = smallest(sum);
    const Vector limit = hn::SaturatedAdd(smallest_sum, hn::Set(bytes, kContradiction));
    FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
      constexpr int kMaskBytes = kLanes / 8;
      hn::StoreMaskBits(bytes, hn::Eq(sum.part[k], smallest_sum),
                        reinterpret_cast<std::uint8_t*>(least) + k * kMaskBytes);
      hn::StoreMaskBits(bytes, atMost(sum.part[k], limit), reinterpret_cast<std::uint8_t*>(set) + k * kMaskBytes);
    }
    right_view.add(sum);
    if (u + 1 == width_px) break;
    hn::StoreU(right_view.last(), bytes, right + width_px - 1 - u + (kVectors - 1) * kLanes);
    right_view.moveOn();
  }
  FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
    hn::StoreU(right_view.winner().part[k], bytes, right + k * kLanes);
  }
}

void minima(const std::uint8_t* sums, int width_px, int words, std::uint64_t* least, std::uint64_t* set,
            std::uint8_t* right) {
  withWords(words, [&](auto constant) { minimaOf<constant * kVectorsOfWord>(sums, width_px, least, set, right); });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace flight_corridor
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flight_corridor {

HWY_EXPORT(minima);

CostMinima::CostMinima(int width_px, int min_disparity_px, int num_disparities)
    : width_px_(width_px),
      min_disparity_px_(min_disparity_px),
      words_(storedDisparities(num_disparities) / 64),
      least_(static_cast<std::size_t>(width_px) * words_),
      right_(width_px + storedDisparities(num_disparities)) {}

void CostMinima::find(const std::uint8_t* sums, const MinimaRow& out) {
  HWY_DYNAMIC_DISPATCH(minima)(sums, width_px_, words_, least_.data(), out.set, right_.data());
  withWords(words_, [&](auto words) { readBits<words>(out); });
  compareViews(out);
}

template <int kWords>
void CostMinima::readBits(const MinimaRow& out) const {
  const std::uint64_t *least = least_.data(), *set = out.set;
  for (int u = 0; u < width_px_; ++u, least += kWords, set += kWords) {
    out.winner[u] = static_cast<std::uint8_t>(firstBit(least, kWords));
    out.farthest[u] = static_cast<std::uint8_t>(firstBit(set, kWords));
    out.nearest[u] = static_cast<std::uint8_t>(lastBit(set, kWords));
  }
}

/// Left pixel u and disparity d meet the right pixel whose winner lies at width - 1 - u + d.
void CostMinima::compareViews(const MinimaRow& out) const {
  const std::uint8_t* right = right_.data() + width_px_ - 1;
  for (int u = 0; u < width_px_; ++u) {
    const int winner = out.winner[u], u_right = u - winner - min_disparity_px_;
    const int nearer = right[winner - u] - winner;  // of the right view's winner, than this one
    const bool seen = 0 <= u_right && u_right < width_px_;
    const int consistent = seen && std::abs(nearer) <= kConsistent_px, hidden = seen && nearer > kConsistent_px;
    out.flags[u] = static_cast<std::uint8_t>(consistent * kConsistent + hidden * kHidden);
  }
}

}  // namespace flight_corridor
#endif
