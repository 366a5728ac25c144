#include "flight_corridor/stereo/subpixel.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "flight_corridor/stereo/cost_minima.hpp"
#include "stereo/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stereo/subpixel.cpp"
#include <hwy/foreach_target.h>

#include "stereo/disparity_lanes-inl.hpp"

#ifndef FLIGHT_CORRIDOR_SUBPIXEL_ONCE
#define FLIGHT_CORRIDOR_SUBPIXEL_ONCE
namespace flight_corridor {
namespace {

constexpr int kPad_px = 8;           // around a row or plane: a window reaches no farther
constexpr int kVectorSlack_px = 33;  // behind rows and planes: a vector reaches no farther
constexpr int kAround_px = 2;        // of an average, from its middle
constexpr std::int64_t kNoise = 60;  // of a window's gradient: 3 squared grey levels a pixel [squared grey levels]

/// The nearest whole number of one above -kSubpixels * 16.
inline int rounded(double value) {
  constexpr int kAboveZero = 16 * kSubpixels;
  return static_cast<int>(value + (kAboveZero + 0.5)) - kAboveZero;
}

/// A quotient and a power of two: rounded alike whatever the compiler contracts.
inline float averageOf(std::int16_t middle, std::int16_t shift, std::int16_t weight) {
  if (middle == kNoSubpixel) return std::numeric_limits<float>::quiet_NaN();
  return (static_cast<float>(middle) + static_cast<float>(shift) / static_cast<float>(weight)) / kSubpixels;
}

/// Rows of both images around one row, from their first pixel on.
struct WindowRows {
  int width_px, min_disparity_px;
  const std::int16_t *left[3], *left_gradient[3], *right[3], *right_gradient[3];
  const std::uint8_t *winner, *flags;
};

}  // namespace
}  // namespace flight_corridor
#endif

HWY_BEFORE_NAMESPACE();
namespace flight_corridor {
namespace HWY_NAMESPACE {
namespace {

using Words = hn::Full128<std::int16_t>;
using Sums = hn::Full128<std::int32_t>;

/// Grey values of a row in 16 bits, and what the ones to the right and left of each differ; the first one's is 0.
void widen(const std::uint8_t* row, int count, std::int16_t* grey, std::int16_t* gradient) {
  const hn::ScalableTag<std::int16_t> words;
  const hn::Rebind<std::uint8_t, decltype(words)> bytes;
  gradient[0] = 0;
  for (int i = 0; i < count; i += static_cast<int>(hn::MaxLanes(words))) {
    hn::StoreU(hn::PromoteTo(words, hn::LoadU(bytes, row + i)), words, grey + i);
    const auto left = hn::PromoteTo(words, hn::LoadU(bytes, row + i));
    hn::StoreU(hn::Sub(hn::PromoteTo(words, hn::LoadU(bytes, row + i + 2)), left), words, gradient + i + 1);
  }
}

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

void windowMoments(const WindowRows& rows, WindowMoments* moments) {
  const Words words;
  const Sums sums;
  const auto one = hn::Set(words, 1);
  const auto window = hn::VecFromMask(words, hn::FirstN(words, 2 * SubpixelFit::kReach_px + 1));
  for (int u = 0; u < rows.width_px; ++u) {
    if (!(rows.flags[u] & kConsistent)) continue;
    const int at = u - SubpixelFit::kReach_px, at_right = at - rows.winner[u] - rows.min_disparity_px;
    auto g_words = hn::Zero(words), e_words = g_words;  // at most 3 x 1020: no sum of three rows overflows
    hn::Vec<Sums> gg = hn::Zero(sums), ge = gg, gg_odd = gg, ge_odd = gg;
    FLIGHT_CORRIDOR_UNROLL for (int row = 0; row < 3; ++row) {
      const auto gradients = hn::Add(hn::LoadU(words, rows.left_gradient[row] + at),
                                     hn::LoadU(words, rows.right_gradient[row] + at_right));
      const auto e = hn::Sub(hn::LoadU(words, rows.right[row] + at_right), hn::LoadU(words, rows.left[row] + at));
      const auto g = hn::And(window, gradients);
      g_words = hn::Add(g_words, g);
      e_words = hn::Add(e_words, e);
      gg = hn::ReorderWidenMulAccumulate(sums, g, g, gg, gg_odd);
      ge = hn::ReorderWidenMulAccumulate(sums, g, e, ge, ge_odd);
    }
    hn::Vec<Sums> g_odd = hn::Zero(sums), e_odd = g_odd;
    const auto g = hn::ReorderWidenMulAccumulate(sums, g_words, one, hn::Zero(sums), g_odd);
    const auto e = hn::ReorderWidenMulAccumulate(sums, hn::And(window, e_words), one, hn::Zero(sums), e_odd);
    const auto all = sumsOfLanes(hn::Add(g, g_odd), hn::Add(e, e_odd), hn::Add(gg, gg_odd), hn::Add(ge, ge_odd));
    hn::StoreU(all, sums, &moments[u].g);
  }
}

/// @param middle the row's first pixel, in a plane with kPad_px more around.
void averages(const std::int16_t* middle, std::ptrdiff_t stride, int width_px, float* best) {
  const hn::ScalableTag<std::int16_t> words;
  constexpr int kWords = static_cast<int>(hn::MaxLanes(words));
  const auto limit = hn::Set(words, kSubpixels);
  for (int u = 0; u < width_px; u += kWords) {
    const auto centre = hn::LoadU(words, middle + u);
    auto shift = hn::Zero(words), weight = hn::Zero(words);  // at most 24 x 32 x 32 and 25 x 64
    for (int dv = -kAround_px; dv <= kAround_px; ++dv) {
      const std::int16_t* const around = middle + u + dv * stride;
      FLIGHT_CORRIDOR_UNROLL for (int du = -kAround_px; du <= kAround_px; ++du) {
        const auto difference = hn::SaturatedSub(hn::LoadU(words, around + du), centre);
        const auto likeness = hn::Max(hn::SaturatedSub(limit, hn::Abs(difference)), hn::Zero(words));
        shift = hn::Add(shift, hn::Mul(difference, likeness));
        weight = hn::Add(weight, likeness);
      }
    }
    std::int16_t shifts[kWords], weights[kWords];
    hn::StoreU(shift, words, shifts);
    hn::StoreU(weight, words, weights);
    for (int i = 0; i < kWords && u + i < width_px; ++i) {
      best[u + i] = averageOf(middle[u + i], shifts[i], weights[i]);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace flight_corridor
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flight_corridor {

HWY_EXPORT(widen);
HWY_EXPORT(windowMoments);
HWY_EXPORT(averages);

/// With p the parabola's offset and l = num / den the shift: p + (l - p) / 2 * den / (den + noise).
int subpixelOffset(int below, int least, int above, const WindowMoments& window) {
  constexpr std::int64_t kPixels = 21, kGradientUnits = 4;
  const std::int64_t slope = below - above, curvature = 2 * (below + above - 2 * least);
  if (curvature <= 0) return 0;
  const double parabola = static_cast<double>(slope * kSubpixels) / static_cast<double>(curvature);
  const std::int64_t g = window.g, e = window.e;
  const std::int64_t num = kGradientUnits * (kPixels * window.ge - g * e), den = kPixels * window.gg - g * g;
  if (!(std::abs(num) < den)) return rounded(parabola);
  const std::int64_t noise = kPixels * kGradientUnits * kGradientUnits * kNoise;
  const double correction = static_cast<double>(kSubpixels / 2 * (num * curvature - slope * den)) /
                            static_cast<double>(curvature * (den + noise));
  return rounded(parabola + correction);
}

SubpixelFit::SubpixelFit(int width_px, int min_disparity_px, int num_disparities)
    : width_px_(width_px),
      min_disparity_px_(min_disparity_px),
      num_disparities_(num_disparities),
      stored_(storedDisparities(num_disparities)),
      row_(width_px + 2 * kPad_px),
      moments_(width_px) {
  for (auto* images : {&grey_, &gradient_}) {
    for (auto& rows : *images) {
      for (auto& row : rows) row.resize(width_px + 2 * kPad_px + kVectorSlack_px);
    }
  }
}

/// What is beyond an image equals its last pixels.
void SubpixelFit::prepare(const GreyImage& image, int v, int side) {
  const auto widen = HWY_DYNAMIC_DISPATCH(widen);
  for (int dv = -1; dv <= 1; ++dv) {
    const std::uint8_t* from = image.row(std::clamp(v + dv, 0, image.height - 1));
    std::uint8_t* const row = row_.data();
    std::memset(row, from[0], kPad_px);
    std::memcpy(row + kPad_px, from, width_px_);
    std::memset(row + kPad_px + width_px_, from[width_px_ - 1], kPad_px);
    widen(row, width_px_ + 2 * kPad_px, grey_[side][dv + 1].data(), gradient_[side][dv + 1].data());
  }
}

void SubpixelFit::fit(const GreyImage& left, const GreyImage& right, int v, const std::uint8_t* sums,
                      const std::uint8_t* winner, const std::uint8_t* flags, std::int16_t* fixed) {
  prepare(left, v, 0);
  prepare(right, v, 1);
  WindowRows rows{width_px_, min_disparity_px_, {}, {}, {}, {}, winner, flags};
  for (int row = 0; row < 3; ++row) {
    rows.left[row] = grey_[0][row].data() + kPad_px;
    rows.left_gradient[row] = gradient_[0][row].data() + kPad_px;
    rows.right[row] = grey_[1][row].data() + kPad_px;
    rows.right_gradient[row] = gradient_[1][row].data() + kPad_px;
  }
  HWY_DYNAMIC_DISPATCH(windowMoments)(rows, moments_.data());
  for (int u = 0; u < width_px_; ++u, sums += stored_) {
    const int d = winner[u];
    const bool inside = 0 < d && d < num_disparities_ - 1;
    const int offset =
        inside && (flags[u] & kConsistent) ? subpixelOffset(sums[d - 1], sums[d], sums[d + 1], moments_[u]) : 0;
    fixed[u] = flags[u] & kConsistent ? static_cast<std::int16_t>(d * kSubpixels + offset) : kNoSubpixel;
  }
}

SubpixelPlane::SubpixelPlane(int width_px, int height_px)
    : width_px_(width_px),
      stride_(static_cast<std::size_t>(width_px) + kPad_px),
      fixed_(at(height_px + kPad_px) + kVectorSlack_px, kNoSubpixel) {}

std::size_t SubpixelPlane::at(int v) const { return static_cast<std::size_t>(v + kPad_px) * stride_ + kPad_px; }

void SubpixelPlane::average(int v, float* best) const {
  HWY_DYNAMIC_DISPATCH(averages)
  (fixed_.data() + at(v), static_cast<std::ptrdiff_t>(stride_), width_px_, best);
}

}  // namespace flight_corridor
#endif
