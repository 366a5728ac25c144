// Curves over disparity in vector registers; compiled once for each of Highway's targets, so no ordinary include guard.
#if defined(FLIGHT_CORRIDOR_DISPARITY_LANES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef FLIGHT_CORRIDOR_DISPARITY_LANES_INL_HPP
#undef FLIGHT_CORRIDOR_DISPARITY_LANES_INL_HPP
#else
#define FLIGHT_CORRIDOR_DISPARITY_LANES_INL_HPP
#endif

#include <hwy/highway.h>

#include <cstdint>
#include <type_traits>

#include "flight_corridor/stereo/matching_rules.hpp"

HWY_BEFORE_NAMESPACE();
namespace flight_corridor {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Bytes = hn::ScalableTag<std::uint8_t>;
using Block = hn::CappedTag<std::uint8_t, 16>;
using Vector = hn::Vec<Bytes>;

constexpr int kLanes = static_cast<int>(hn::MaxLanes(Bytes()));
constexpr int kVectorsOfWord = kDisparityStep / kLanes;  // one word of disparity_bits.hpp has a bit for each lane
static_assert(kLanes >= 16 && kDisparityStep == 64 && 64 % kLanes == 0, "vectors of 16, 32 or 64 bytes");

/// One value for each disparity of a pixel, ascending.
template <int kVectors>
struct Curve {
  HWY_INLINE Curve() {}  // GCC does not compile an implicit one for the target

  Vector part[kVectors];
};

#undef FLIGHT_CORRIDOR_UNROLL
#if HWY_TARGET == HWY_EMU128  // its vectors are loops themselves: clang would be at it for minutes
#define FLIGHT_CORRIDOR_UNROLL _Pragma("GCC unroll 1")
#else
#define FLIGHT_CORRIDOR_UNROLL _Pragma("GCC unroll 16")
#endif

template <int kVectors>
HWY_INLINE Curve<kVectors> load(const std::uint8_t* from) {
  Curve<kVectors> curve;
  FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) curve.part[k] = hn::Load(Bytes(), from + k * kLanes);
  return curve;
}

template <int kVectors>
HWY_INLINE void store(const Curve<kVectors>& curve, std::uint8_t* to) {
  FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) hn::Store(curve.part[k], Bytes(), to + k * kLanes);
}

template <int kVectors>
HWY_INLINE Curve<kVectors> filled(std::uint8_t value) {
  Curve<kVectors> curve;
  FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) curve.part[k] = hn::Set(Bytes(), value);
  return curve;
}

/// The lanes one up: the last one of below, then all but the last one of vector.
HWY_INLINE Vector shiftedUp(Vector vector, Vector below) {
#if HWY_TARGET <= HWY_AVX3
  const Vector blocks{_mm512_alignr_epi64(vector.raw, below.raw, 6)};
#elif HWY_TARGET <= HWY_AVX2
  const Vector blocks = hn::ConcatLowerUpper(Bytes(), vector, below);
#else
  const Vector blocks = below;
#endif
  return hn::CombineShiftRightBytes<15>(Bytes(), vector, blocks);
}

/// The lanes one down: all but the first one of vector, then the first one of above.
HWY_INLINE Vector shiftedDown(Vector vector, Vector above) {
#if HWY_TARGET <= HWY_AVX3
  const Vector blocks{_mm512_alignr_epi64(above.raw, vector.raw, 2)};
#elif HWY_TARGET <= HWY_AVX2
  const Vector blocks = hn::ConcatLowerUpper(Bytes(), above, vector);
#else
  const Vector blocks = above;
#endif
  return hn::CombineShiftRightBytes<1>(Bytes(), blocks, vector);
}

/// Where a value is not above a limit; Highway 1.0.3 compares bytes with a sign only.
HWY_INLINE hn::Mask<Bytes> atMost(Vector value, Vector limit) {
#if HWY_TARGET <= HWY_AVX3
  return hn::Mask<Bytes>{_mm512_cmple_epu8_mask(value.raw, limit.raw)};
#else
  return hn::Eq(hn::Min(value, limit), value);
#endif
}

/// Puts the bits of a curve's k-th vector into a set.
HWY_INLINE void addBits(hn::Mask<Bytes> mask, int k, std::uint64_t* set) {
  std::conditional_t<kLanes == 64, std::uint64_t, std::conditional_t<kLanes == 32, std::uint32_t, std::uint16_t>> bits;
  hn::StoreMaskBits(Bytes(), mask, reinterpret_cast<std::uint8_t*>(&bits));
  set[k / kVectorsOfWord] |= std::uint64_t{bits} << k % kVectorsOfWord * kLanes;
}

/// The curve moved to disparities larger by one; first comes in at the smallest.
template <int kVectors>
HWY_INLINE Curve<kVectors> shiftedUp(const Curve<kVectors>& curve, Vector first) {
  Curve<kVectors> shifted;
  shifted.part[0] = shiftedUp(curve.part[0], first);
  FLIGHT_CORRIDOR_UNROLL for (int k = 1; k < kVectors; ++k) {
    shifted.part[k] = shiftedUp(curve.part[k], curve.part[k - 1]);
  }
  return shifted;
}

/// Of two neighbouring disparities the smaller value, for each disparity between them; 255 beyond the ends.
template <int kVectors>
HWY_INLINE Curve<kVectors> smallerNeighbour(const Curve<kVectors>& curve) {
  const Vector beyond = hn::Set(Bytes(), 255);
  Curve<kVectors> smaller;
  FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
    const Vector below = k > 0 ? curve.part[k > 0 ? k - 1 : 0] : beyond;
    const Vector above = k + 1 < kVectors ? curve.part[k + 1 < kVectors ? k + 1 : k] : beyond;
    smaller.part[k] = hn::Min(shiftedUp(curve.part[k], below), shiftedDown(curve.part[k], above));
  }
  return smaller;
}

/// The smallest of 16 lanes, in all lanes of a vector.
HWY_INLINE Vector smallestOfBlock(hn::Vec<Block> block) {
  const hn::Repartition<std::uint16_t, Block> words;
  const auto word = hn::BitCast(words, block);
  const auto pairs = hn::BitCast(words, hn::Min(block, hn::BitCast(Block(), hn::ShiftRight<8>(word))));
#if HWY_TARGET <= HWY_AVX3
  return Vector{_mm512_broadcastb_epi8(_mm_minpos_epu16(pairs.raw))};
#elif HWY_TARGET <= HWY_AVX2
  return Vector{_mm256_broadcastb_epi8(_mm_minpos_epu16(pairs.raw))};
#else
  const auto smallest = hn::MinOfLanes(words, pairs);
  return hn::BitCast(Bytes(), hn::Or(smallest, hn::ShiftLeft<8>(smallest)));
#endif
}

/// The smallest value of a curve, in all lanes.
template <int kVectors>
HWY_INLINE Vector smallest(const Curve<kVectors>& curve) {
  Vector least = curve.part[0];
  FLIGHT_CORRIDOR_UNROLL for (int k = 1; k < kVectors; ++k) least = hn::Min(least, curve.part[k]);
#if HWY_TARGET <= HWY_AVX3
  const hn::Half<Bytes> half;
  const auto two = hn::Min(hn::LowerHalf(half, least), hn::UpperHalf(half, least));
  return smallestOfBlock(hn::Min(hn::LowerHalf(Block(), two), hn::UpperHalf(Block(), two)));
#elif HWY_TARGET <= HWY_AVX2
  return smallestOfBlock(hn::Min(hn::LowerHalf(Block(), least), hn::UpperHalf(Block(), least)));
#else
  return smallestOfBlock(least);
#endif
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace flight_corridor
HWY_AFTER_NAMESPACE();

#endif
