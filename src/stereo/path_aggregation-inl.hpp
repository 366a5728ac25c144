// Census codes, matching costs, and their sums over paths; compiled once for each of Highway's targets.
#if defined(FLIGHT_CORRIDOR_PATH_AGGREGATION_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef FLIGHT_CORRIDOR_PATH_AGGREGATION_INL_HPP
#undef FLIGHT_CORRIDOR_PATH_AGGREGATION_INL_HPP
#else
#define FLIGHT_CORRIDOR_PATH_AGGREGATION_INL_HPP
#endif

#include <algorithm>

#include "stereo/disparity_lanes-inl.hpp"
#include "stereo/row_matcher.hpp"

HWY_BEFORE_NAMESPACE();
namespace flight_corridor {
namespace HWY_NAMESPACE {
namespace {

/// bit where a pixel is brighter than another.
HWY_INLINE Vector brighter(const std::uint8_t* one, const std::uint8_t* other, int bit) {
  const Bytes bytes;
  const Vector excess = hn::SaturatedSub(hn::LoadU(bytes, one), hn::LoadU(bytes, other));
  return hn::IfThenElseZero(hn::Gt(excess, hn::Set(bytes, kBrighter_grey)),
                            hn::Set(bytes, static_cast<std::uint8_t>(1u << bit)));
}

void censusCodes(const std::uint8_t* above, const std::uint8_t* middle, const std::uint8_t* below, int width_px,
                 std::array<AlignedBytes, 2>& out) {
  const Bytes bytes;
  for (int u = 0; u < width_px; u += kLanes) {
    const std::uint8_t *a = above + u, *m = middle + u, *b = below + u;
    Vector codes[2] = {hn::Zero(bytes), hn::Zero(bytes)};
    int bit = 0;
    const auto add = [&](const std::uint8_t* one, const std::uint8_t* other) HWY_ATTR {
      codes[bit / 8] = hn::Or(codes[bit / 8], brighter(one, other, bit % 8));
      ++bit;
    };
    FLIGHT_CORRIDOR_UNROLL for (int du = -kCensusReach_px; du <= kCensusReach_px; ++du) add(a + du, b - du);
    FLIGHT_CORRIDOR_UNROLL for (int du = 1; du <= kCensusReach_px; ++du) add(m - du, m + du);
    FLIGHT_CORRIDOR_UNROLL for (int du = -1; du <= 1; ++du) add(a + du, m);
    for (int part = 0; part < 2; ++part) hn::StoreU(codes[part], bytes, out[part].get() + u);
  }
}

/// P2 of the steps between the pixels of two rows.
void penalties(const std::uint8_t* to, const std::uint8_t* from, int count, std::uint8_t* out) {
  const Bytes bytes;
  const Vector edge = hn::Set(bytes, kEdgeStepPenalty), even = hn::Set(bytes, kLargeStepPenalty);
  for (int i = 0; i < count; i += kLanes) {
    const Vector one = hn::LoadU(bytes, to + i), other = hn::LoadU(bytes, from + i);
    const Vector step = hn::Or(hn::SaturatedSub(one, other), hn::SaturatedSub(other, one));
    hn::StoreU(hn::IfThenElse(atMost(step, hn::Set(bytes, kEdge_grey)), even, edge), bytes, out + i);
  }
}

/// Codes of row v, and P2 of the steps to it. Values read beyond the ends belong to steps at a path's start, where they
/// have no effect.
void prepareRow(RowMatcher& m, int v) {
  const int width = m.size.width_px, smallest = m.size.min_disparity_px;
  censusCodes(m.leftRow(v - 1), m.leftRow(v), m.leftRow(v + 1), width, m.left_codes);
  censusCodes(m.rightRow(v - 1), m.rightRow(v), m.rightRow(v + 1), width, m.right_codes);
  const int first = std::max(0, -smallest), end = std::min(width + m.stored, width - smallest);
  for (int part = 0; part < 2; ++part) {
    std::uint8_t* mirrored = m.mirrored[part].get();
    const std::uint8_t* last_code = m.right_codes[part].get() + width - 1 - smallest;
    for (int i = first; i < end; ++i) mirrored[i] = last_code[-i];
  }
  const std::uint8_t *row = m.leftRow(v), *above = m.leftRow(v - 1);
  penalties(row, row - 1, width + 1, m.level.get());
  for (int path = 0; path < 3; ++path) {
    constexpr int kFrom[] = {0, -1, 1};
    penalties(row, above + kFrom[path], width, m.from_above[path].get());
  }
}

/// The term that a step of a path adds to C(p, d), before eq. 13 subtracts the minimum.
/// @param before L(q, d).  @param neighbour the smaller of L(q, d -+ 1).  @param jump min L(q) + P2.
HWY_INLINE Vector stepped(Vector before, Vector neighbour, Vector jump) {
  const Vector small_step = hn::SaturatedAdd(neighbour, hn::Set(Bytes(), kSmallStepPenalty));
  return hn::Min(hn::Min(before, small_step), jump);
}

/// A path along the row: L of the pixel before, and its minimum.
template <int kVectors>
struct AlongPath {
  HWY_INLINE AlongPath() : length(filled<kVectors>(0)), least(hn::Zero(Bytes())) {}

  HWY_INLINE void step(const Curve<kVectors>& costs, std::uint8_t penalty) {
    const Vector jump = hn::SaturatedAdd(least, hn::Set(Bytes(), penalty));
    const Curve<kVectors> neighbour = smallerNeighbour(length);
    FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
      const Vector step = hn::SaturatedSub(stepped(length.part[k], neighbour.part[k], jump), least);
      length.part[k] = hn::SaturatedAdd(step, costs.part[k]);
    }
    least = smallest(length);
  }

  Curve<kVectors> length;
  Vector least;
};

HWY_INLINE Vector hammingDistance(const RowMatcher& m, const Vector (&left)[2], int mirrored_u) {
  const Bytes bytes;
  return hn::Add(hn::PopulationCount(hn::Xor(left[0], hn::LoadU(bytes, m.mirrored[0].get() + mirrored_u))),
                 hn::PopulationCount(hn::Xor(left[1], hn::LoadU(bytes, m.mirrored[1].get() + mirrored_u))));
}

/// The costs of a row and, where it has sums, the path from the right, which begins them.
template <int kVectors, bool kSums>
HWY_NOINLINE void costsOf(RowMatcher& m, int v) {
  const Bytes bytes;
  const int width = m.size.width_px, last_px = m.size.min_disparity_px + m.size.num_disparities - 1;
  const int first_whole_u = m.size.num_disparities == m.stored ? last_px : width;
  const int last_whole_u = std::min(width, width + m.size.min_disparity_px) - 1;
  AlongPath<kVectors> from_right;
  for (int u = width - 1; u >= 0; --u) {
    const Vector left[2] = {hn::Set(bytes, m.left_codes[0][u]), hn::Set(bytes, m.left_codes[1][u])};
    const int mirrored_u = width - 1 - u;
    Curve<kVectors> costs;
    FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
      costs.part[k] = hammingDistance(m, left, mirrored_u + k * kLanes);
    }
    if (u < first_whole_u || last_whole_u < u) {
      FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
        const auto unseen = hn::Ne(hn::LoadU(bytes, m.unseen.get() + mirrored_u + k * kLanes), hn::Zero(bytes));
        costs.part[k] = hn::Or(hn::IfThenElse(unseen, hn::Set(bytes, kUnseenCost), costs.part[k]),
                               hn::Load(bytes, m.beyond.get() + k * kLanes));
      }
    }
    const std::size_t at = static_cast<std::size_t>(u) * kVectors * kLanes;
    store(costs, m.costsOf(v) + at);
    if (!kSums) continue;
    from_right.step(costs, m.level[u + 1]);
    store(from_right.length, m.sums.get() + at);
  }
}

/// L of the next pixel of a path from above.
/// @param path L of the pixel before, less its minimum; replaced by that of this pixel.  @param sum L is added.
template <int kVectors>
HWY_INLINE void stepDown(const Curve<kVectors>& costs, std::uint8_t penalty, std::uint8_t* path, Curve<kVectors>& sum) {
  const Vector jump = hn::Set(Bytes(), penalty);
  Curve<kVectors> length = load<kVectors>(path);
  const Curve<kVectors> neighbour = smallerNeighbour(length);
  FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
    length.part[k] = hn::SaturatedAdd(stepped(length.part[k], neighbour.part[k], jump), costs.part[k]);
    sum.part[k] = hn::SaturatedAdd(sum.part[k], length.part[k]);
  }
  const Vector least = smallest(length);
  FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
    length.part[k] = hn::SaturatedSub(length.part[k], least);
  }
  store(length, path);
}

/// The paths from above and, where the row has sums, from the left, at pixels [first_u, end_u). An oblique path comes
/// to pixel u from u -+ 1, and both keep its place in memory, which is that of pixel u - row or u + row around the end
/// of the row; one that comes in at a side begins anew.
template <int kVectors, bool kSums>
HWY_NOINLINE void sweep(RowMatcher& m, int v, int first_u, int end_u, AlongPath<kVectors>& path) {
  constexpr std::size_t kStored = kVectors * kLanes;
  const int width = m.size.width_px, shift = m.rows % width;
  const std::uint8_t *const row_costs = m.costsOf(v), *const level = m.level.get();
  const std::uint8_t* const penalties[] = {m.from_above[0].get(), m.from_above[1].get(), m.from_above[2].get()};
  std::uint8_t *const sums = m.sums.get(), *const above = m.above.get();
  std::uint8_t *const above_left = m.above_left.get(), *const above_right = m.above_right.get();
  int left_at = (first_u + width - shift) % width, right_at = (first_u + shift) % width;
  if (first_u == 0) store(filled<kVectors>(0), above_left + left_at * kStored);
  if (end_u == width) store(filled<kVectors>(0), above_right + (shift + width - 1) % width * kStored);
  AlongPath<kVectors> from_left = path;
  for (int u = first_u; u < end_u; ++u) {
    const std::size_t at = u * kStored;
    const Curve<kVectors> costs = load<kVectors>(row_costs + at);
    Curve<kVectors> sum = costs;
    if (kSums) {
      from_left.step(costs, level[u]);
      sum = load<kVectors>(sums + at);
      FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
        sum.part[k] = hn::SaturatedAdd(sum.part[k], from_left.length.part[k]);
      }
    }
    stepDown(costs, penalties[0][u], above + at, sum);
    stepDown(costs, penalties[1][u], above_left + left_at * kStored, sum);
    stepDown(costs, penalties[2][u], above_right + right_at * kStored, sum);
    if (kSums) store(sum, sums + at);
    if (++left_at == width) left_at = 0;
    if (++right_at == width) right_at = 0;
  }
  path = from_left;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace flight_corridor
HWY_AFTER_NAMESPACE();

#endif
