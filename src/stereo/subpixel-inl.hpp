// Sub-pixel positions of matches; compiled once for each of Highway's targets.
#if defined(FLIGHT_CORRIDOR_SUBPIXEL_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef FLIGHT_CORRIDOR_SUBPIXEL_INL_HPP
#undef FLIGHT_CORRIDOR_SUBPIXEL_INL_HPP
#else
#define FLIGHT_CORRIDOR_SUBPIXEL_INL_HPP
#endif

#include <algorithm>
#include <limits>

#include "stereo/disparity_lanes-inl.hpp"
#include "stereo/row_matcher.hpp"

HWY_BEFORE_NAMESPACE();
namespace flight_corridor {
namespace HWY_NAMESPACE {
namespace {

using Window = hn::Full128<std::int16_t>;
using Sums = hn::Full128<std::int32_t>;
using Longs = hn::ScalableTag<std::int32_t>;
using LongVector = hn::Vec<Longs>;

/// The sums over the lanes of four vectors.
HWY_INLINE hn::Vec<Sums> sumsOfLanes(hn::Vec<Sums> a, hn::Vec<Sums> b, hn::Vec<Sums> c, hn::Vec<Sums> d) {
  const Sums sums;
  const hn::Full128<std::int64_t> pairs;
  const auto ab = hn::Add(hn::InterleaveLower(sums, a, b), hn::InterleaveUpper(sums, a, b));
  const auto cd = hn::Add(hn::InterleaveLower(sums, c, d), hn::InterleaveUpper(sums, c, d));
  const auto first = hn::InterleaveLower(pairs, hn::BitCast(pairs, ab), hn::BitCast(pairs, cd));
  const auto second = hn::InterleaveUpper(pairs, hn::BitCast(pairs, ab), hn::BitCast(pairs, cd));
  return hn::Add(hn::BitCast(sums, first), hn::BitCast(sums, second));
}

/// g, e, gg, ge of the matched pixels of a row.
HWY_NOINLINE void windowMoments(RowMatcher& m, int v) {
  const Window words;
  const Sums sums;
  const auto one = hn::Set(words, 1), window = hn::VecFromMask(words, hn::FirstN(words, 2 * kWindowReach_px + 1));
  const auto grey = [](const std::uint8_t* from) HWY_ATTR {
    return hn::PromoteTo(Window(), hn::LoadU(hn::Rebind<std::uint8_t, Window>(), from));
  };
  const RowMatcher::Found& found = m.found[v & 1];
  for (int u = 0; u < m.size.width_px; ++u) {
    if (!(found.flags[u] & kDistinct)) continue;
    const int at = u - kWindowReach_px, at_right = at - found.winner[u] - m.size.min_disparity_px;
    auto g_words = hn::Zero(words), e_words = g_words;  // at most 3 x 1020: no sum of three rows overflows
    hn::Vec<Sums> gg = hn::Zero(sums), ge = gg, gg_odd = gg, ge_odd = gg;
    FLIGHT_CORRIDOR_UNROLL for (int dv = -1; dv <= 1; ++dv) {
      const std::uint8_t *left = m.leftRow(v + dv) + at, *right = m.rightRow(v + dv) + at_right;
      const auto after = hn::Add(grey(left + 1), grey(right + 1)), before = hn::Add(grey(left - 1), grey(right - 1));
      const auto g = hn::And(window, hn::Sub(after, before)), e = hn::Sub(grey(right), grey(left));
      g_words = hn::Add(g_words, g);
      e_words = hn::Add(e_words, e);
      gg = hn::ReorderWidenMulAccumulate(sums, g, g, gg, gg_odd);
      ge = hn::ReorderWidenMulAccumulate(sums, g, e, ge, ge_odd);
    }
    hn::Vec<Sums> g_odd = hn::Zero(sums), e_odd = g_odd;
    const auto g = hn::ReorderWidenMulAccumulate(sums, g_words, one, hn::Zero(sums), g_odd);
    const auto e = hn::ReorderWidenMulAccumulate(sums, hn::And(window, e_words), one, hn::Zero(sums), e_odd);
    const auto all = sumsOfLanes(hn::Add(g, g_odd), hn::Add(e, e_odd), hn::Add(gg, gg_odd), hn::Add(ge, ge_odd));
    hn::StoreU(all, sums, &m.moments[4 * static_cast<std::size_t>(u)]);
  }
}

HWY_INLINE LongVector times(LongVector vector, int factor) { return hn::Mul(vector, hn::Set(Longs(), factor)); }

HWY_INLINE LongVector loadBytes(const std::uint8_t* from) {
  return hn::PromoteTo(Longs(), hn::LoadU(hn::Rebind<std::uint8_t, Longs>(), from));
}

/// 2^kBits part / whole, rounded downwards, by long division.  @param part not negative, not above whole.
template <int kBits>
HWY_INLINE LongVector quotient(LongVector part, LongVector whole) {
  const LongVector one = hn::Set(Longs(), 1);
  LongVector bits = hn::Zero(Longs());
  FLIGHT_CORRIDOR_UNROLL for (int i = 0; i < kBits; ++i) {
    part = hn::Add(part, part);
    const auto below = hn::Lt(part, whole);
    part = hn::Sub(part, hn::IfThenZeroElse(below, whole));
    bits = hn::Add(hn::Add(bits, bits), hn::IfThenZeroElse(below, one));
  }
  return bits;
}

/// A half, rounded away from zero.
HWY_INLINE LongVector half(LongVector value) {
  return hn::ShiftRight<1>(hn::Add(value, hn::IfThenElseZero(hn::Gt(value, hn::Zero(Longs())), hn::Set(Longs(), 1))));
}

HWY_INLINE LongVector withSignOf(LongVector sign, LongVector magnitude) {
  return hn::IfThenElse(hn::Lt(sign, hn::Zero(Longs())), hn::Neg(magnitude), magnitude);
}

/// Sub-pixel index of a row's matches, by the equations of matching_rules.hpp.
void fit(RowMatcher& m, int v, std::int16_t* fixed) {
  constexpr int kPixels = 3 * (2 * kWindowReach_px + 1);
  static_assert(kSubpixels == 64 && kNoise % kSubpixels == 0, "bits of the quotients, and a whole product");
  windowMoments(m, v);
  const Longs longs;
  const RowMatcher::Found& found = m.found[v & 1];
  for (int u = 0; u < m.size.width_px; u += static_cast<int>(hn::MaxLanes(longs))) {
    const LongVector below = loadBytes(&found.rise_below[u]), above = loadBytes(&found.rise_above[u]);
    const LongVector slope = hn::Sub(below, above), rise = hn::Add(below, above);
    const LongVector p = withSignOf(slope, half(quotient<6>(hn::Abs(slope), rise)));
    LongVector g, e, gg, ge;
    hn::LoadInterleaved4(longs, &m.moments[4 * static_cast<std::size_t>(u)], g, e, gg, ge);
    const LongVector num = hn::ShiftLeft<2>(hn::Sub(times(ge, kPixels), hn::Mul(g, e)));
    const LongVector den = hn::Sub(times(gg, kPixels), hn::Mul(g, g));
    const LongVector drawn = hn::Add(num, times(p, kNoise / kSubpixels));
    const LongVector shift = half(quotient<7>(hn::Abs(drawn), hn::Add(den, hn::Set(longs, kNoise))));
    const LongVector mean = half(hn::Add(p, withSignOf(drawn, shift)));
    const LongVector offset = hn::IfThenElse(hn::Lt(hn::Abs(num), den), mean, p);
    const LongVector index = hn::Add(times(loadBytes(&found.winner[u]), kSubpixels),
                                     hn::IfThenElseZero(hn::Gt(rise, hn::Zero(longs)), offset));
    const auto matched = hn::Ne(hn::And(loadBytes(&found.flags[u]), hn::Set(longs, kDistinct)), hn::Zero(longs));
    const hn::Rebind<std::int16_t, Longs> words;
    hn::StoreU(hn::DemoteTo(words, hn::IfThenElse(matched, index, hn::Set(longs, kNoSubpixel))), words, fixed + u);
  }
}

using Words = hn::ScalableTag<std::int16_t>;
constexpr int kWordLanes = static_cast<int>(hn::MaxLanes(Words())),
              kLongLanes = static_cast<int>(hn::MaxLanes(Longs()));

/// The excess of a pixel's average over its own value, as a quotient.  @param middle in a plane with room around.
HWY_INLINE void average(const std::int16_t* middle, std::ptrdiff_t stride, std::int16_t* part, std::int16_t* whole) {
  const Words words;
  const hn::RebindToUnsigned<Words> unsigned_words;
  const auto limit = hn::Set(unsigned_words, kSubpixels);
  const auto centre = hn::LoadU(words, middle);
  auto shift = hn::Zero(words), weight = hn::Zero(words);  // at most 24 x 32 x 32 and 25 x 64
  for (int dv = -kAverageReach_px; dv <= kAverageReach_px; ++dv) {
    const std::int16_t* const around = middle + dv * stride;
    FLIGHT_CORRIDOR_UNROLL for (int du = -kAverageReach_px; du <= kAverageReach_px; ++du) {
      const auto difference = hn::SaturatedSub(hn::LoadU(words, around + du), centre);
      const auto apart = hn::BitCast(unsigned_words, hn::Abs(difference));
      const auto likeness = hn::BitCast(words, hn::SaturatedSub(limit, apart));
      shift = hn::Add(shift, hn::Mul(difference, likeness));
      weight = hn::Add(weight, likeness);
    }
  }
  hn::StoreU(shift, words, part);
  hn::StoreU(weight, words, whole);
}

HWY_INLINE LongVector loadWords(const std::int16_t* from) {
  return hn::PromoteTo(Longs(), hn::LoadU(hn::Rebind<std::int16_t, Longs>(), from));
}

/// @param middle the row's first pixel.  @param flags, best, repeated the row's.
void averageRow(const std::int16_t* middle, std::ptrdiff_t stride, const MatcherSize& size, const std::uint8_t* flags,
                float* best, float* repeated) {
  static_assert(kSubpixels * kFineSteps == 1024, "bits of the quotient, for a shift is below kSubpixels weights");
  const hn::RebindToFloat<Longs> floats;
  const auto first_px = hn::Set(floats, static_cast<float>(size.min_disparity_px) - size.offset_px);
  const auto none = hn::Set(floats, std::numeric_limits<float>::quiet_NaN());
  std::int16_t shifts[kWordLanes], weights[kWordLanes];
  std::uint8_t is_repeated[kWordLanes] = {};
  float found[kWordLanes], of_pattern[kWordLanes];
  for (int u = 0; u < size.width_px; u += kWordLanes) {
    const int count = std::min(kWordLanes, size.width_px - u);
    average(middle + u, stride, shifts, weights);
    std::copy_n(flags + u, count, is_repeated);
    for (int i = 0; i < kWordLanes; i += kLongLanes) {
      const LongVector shift = loadWords(shifts + i), whole = times(loadWords(weights + i), kSubpixels);
      const LongVector change = withSignOf(shift, quotient<10>(hn::Abs(shift), whole));
      const LongVector fine = hn::Add(times(loadWords(middle + u + i), kFineSteps), change);
      const auto px = hn::Add(hn::Mul(hn::ConvertTo(floats, fine), hn::Set(floats, 1.0f / 1024)), first_px);
      const auto match = hn::IfThenElse(hn::Ge(px, hn::Set(floats, -kLargestOffset_px)),
                                        hn::Max(px, hn::Set(floats, kSmallestDisparity_px)), none);
      const auto is_none = hn::RebindMask(floats, hn::Lt(fine, hn::Zero(Longs())));
      const LongVector bit = hn::And(loadBytes(is_repeated + i), hn::Set(Longs(), kRepeated));
      const auto is_other = hn::RebindMask(floats, hn::Gt(bit, hn::Zero(Longs())));
      hn::StoreU(hn::IfThenElse(hn::Or(is_none, is_other), none, match), floats, found + i);
      hn::StoreU(hn::IfThenElse(hn::AndNot(is_none, is_other), match, none), floats, of_pattern + i);
    }
    std::copy_n(found, count, best + u);
    std::copy_n(of_pattern, count, repeated + u);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace flight_corridor
HWY_AFTER_NAMESPACE();

#endif
