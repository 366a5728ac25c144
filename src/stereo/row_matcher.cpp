#include "stereo/row_matcher.hpp"

#include <algorithm>
#include <cstring>

#include "flight_corridor/stereo/disparity_bits.hpp"
#include "stereo/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stereo/row_matcher.cpp"
#include <hwy/foreach_target.h>

#include "stereo/evidence-inl.hpp"
#include "stereo/path_aggregation-inl.hpp"
#include "stereo/subpixel-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace flight_corridor {
namespace HWY_NAMESPACE {
namespace {

/// Takes row v into a band of rows [first_v, end_v): its costs, its paths and their minima; and what needs the costs of
/// the row below, of the row before.
template <int kVectors>
void matchRowOf(RowMatcher& m, int v, int first_v, int end_v, const MatchPlanes& out, std::int16_t* fixed) {
  const int width = m.size.width_px, words = m.words;
  const bool has_sums = first_v <= v && v<end_v, judges = v> first_v;
  if (v < m.size.height_px) {
    prepareRow(m, v);
    has_sums ? costsOf<kVectors, true>(m, v) : costsOf<kVectors, false>(m, v);
  }
  const std::size_t at = static_cast<std::size_t>(v) * width, before = judges ? at - width : at;
  AlongPath<kVectors> from_left;
  RightView<kVectors> right_view;
  Curve<kVectors> window = filled<kVectors>(0);
  for (int first_u = 0; first_u < width; first_u += kBlock_px) {
    const int end_u = std::min(first_u + kBlock_px, width);
    if (has_sums) {
      sweep<kVectors, true>(m, v, first_u, end_u, from_left);
      findMinima(m, v, first_u, end_u, right_view, out.set + at * words);
    } else if (v < first_v) {
      sweep<kVectors, false>(m, v, first_u, end_u, from_left);
    }
    if (judges) {
      moveWindow(m, v - 1, first_u, end_u, window);
      judge<kVectors>(m, v - 1, first_u, end_u, m.windows.get(), out.competitor_farthest + before,
                      out.competitor_nearest + before);
    }
  }
  ++m.rows;
  if (has_sums) compareViews(m, v, right_view);
  if (!judges) return;
  fit(m, v - 1, fixed);
  std::copy_n(m.found[(v - 1) & 1].flags.get(), width, out.flags + before);
}

void matchRow(RowMatcher& m, int v, int first_v, int end_v, const MatchPlanes& out, std::int16_t* fixed) {
  switch (m.words) {
    case 1:
      return matchRowOf<1 * kVectorsOfWord>(m, v, first_v, end_v, out, fixed);
    case 2:
      return matchRowOf<2 * kVectorsOfWord>(m, v, first_v, end_v, out, fixed);
    case 3:
      return matchRowOf<3 * kVectorsOfWord>(m, v, first_v, end_v, out, fixed);
    default:
      return matchRowOf<4 * kVectorsOfWord>(m, v, first_v, end_v, out, fixed);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace flight_corridor
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flight_corridor {

HWY_EXPORT(matchRow);
HWY_EXPORT(averageRow);

namespace {

AlignedBytes zeros(std::size_t size) {
  AlignedBytes bytes(static_cast<std::uint8_t*>(::operator new(size + kVectorSlack_px, kAlignment)));
  std::fill_n(bytes.get(), size + kVectorSlack_px, std::uint8_t{0});
  return bytes;
}

/// Beyond an image its last pixels are repeated.
void pad(const GreyImage& image, int v, std::uint8_t* row) {
  const std::uint8_t* from = image.row(std::clamp(v, 0, image.height - 1));
  std::memset(row, from[0], kPad_px);
  std::memcpy(row + kPad_px, from, image.width);
  std::memset(row + kPad_px + image.width, from[image.width - 1], kPad_px);
}

}  // namespace

RowMatcher::RowMatcher(const MatcherSize& matcher_size)
    : size(matcher_size),
      stored(storedDisparities(size.num_disparities)),
      words(stored / 64),
      seen(static_cast<std::size_t>(size.width_px) * words),
      whole(seen.size()),
      moments(4 * static_cast<std::size_t>(size.width_px + kVectorSlack_px)) {
  const std::size_t width = size.width_px, row = width * stored;
  for (auto* images : {&left, &right}) {
    for (AlignedBytes& image : *images) image = zeros(width + 2 * kPad_px);
  }
  for (auto* codes : {&left_codes, &right_codes, &mirrored}) {
    for (AlignedBytes& part : *codes) part = zeros(width + stored);
  }
  for (AlignedBytes* one : {&unseen, &right_winner}) *one = zeros(width + stored);
  for (AlignedBytes* one : {&costs[0], &costs[1], &costs[2], &sums, &above, &above_left, &above_right})
    *one = zeros(row);
  for (AlignedBytes* one : {&level, &from_above[0], &from_above[1], &from_above[2]}) *one = zeros(width);
  for (Found& one : found) {
    for (AlignedBytes* of : {&one.winner, &one.rise_below, &one.rise_above, &one.flags}) *of = zeros(width);
  }
  beyond = zeros(stored);
  columns = zeros(static_cast<std::size_t>(kColumns) * stored);
  windows = zeros(static_cast<std::size_t>(kBlock_px) * stored);
  std::fill(beyond.get() + size.num_disparities, beyond.get() + stored, kNoDisparityCost);
  const int last_u = size.width_px - 1, last = size.num_disparities - 1;
  for (int i = 0; i < size.width_px + stored; ++i) {
    const int u_right = last_u - i - size.min_disparity_px;
    unseen[i] = 0 <= u_right && u_right <= last_u ? 0 : 255;
  }
  for (int u = 0; u <= last_u; ++u) {
    const auto fill = [&](std::vector<std::uint64_t>& sets, int first_seen, int last_seen) {
      for (int k = 0; k < words; ++k) {
        sets[static_cast<std::size_t>(u) * words + k] =
            bitsFrom(bitsTo(~std::uint64_t{0}, k, last_seen), k, first_seen);
      }
    };
    const int right_most = std::min(u + kWindowReach_px, last_u), left_most = std::max(u - kWindowReach_px, 0);
    fill(seen, std::max(0, u - last_u - size.min_disparity_px), std::min(last, u - size.min_disparity_px));
    fill(whole, std::max(0, right_most - last_u - size.min_disparity_px),
         std::min(last, left_most - size.min_disparity_px));
  }
}

void RowMatcher::matchBand(const ImagePair& images, int first_v, int end_v, const MatchPlanes& out,
                           SubpixelPlane& fixed) {
  const int begin_v = std::max(0, first_v - SemiGlobalMatcher::kRunUp_px);
  rows = 0;
  for (AlignedBytes* paths : {&above, &above_left, &above_right}) {
    std::fill_n(paths->get(), static_cast<std::size_t>(size.width_px) * stored, std::uint8_t{0});
  }
  for (int v = begin_v; v <= end_v; ++v) {
    for (int next = v == begin_v ? v - 1 : v + 1; next <= v + 1; ++next) {
      pad(images.left, next, left[next & 3].get());
      pad(images.right, next, right[next & 3].get());
    }
    HWY_DYNAMIC_DISPATCH(matchRow)(*this, v, first_v, end_v, out, fixed.row(std::max(v - 1, 0)));
  }
}

SubpixelPlane::SubpixelPlane(const MatcherSize& size)
    : size_(size),
      stride_(static_cast<std::size_t>(size.width_px) + kPad_px),
      fixed_((size.height_px + 2 * kAverageReach_px) * stride_ + kPad_px + kVectorSlack_px, kNoSubpixel) {}

void SubpixelPlane::average(int v, const MatchPlanes& out) {
  const std::size_t at = static_cast<std::size_t>(v) * size_.width_px;
  HWY_DYNAMIC_DISPATCH(averageRow)
  (row(v), static_cast<std::ptrdiff_t>(stride_), size_, out.flags + at, out.best + at, out.repeated + at);
}

}  // namespace flight_corridor
#endif
