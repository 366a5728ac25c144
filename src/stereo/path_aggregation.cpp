#include "flight_corridor/stereo/path_aggregation.hpp"

#include <cstring>
#include <utility>

#include "flight_corridor/stereo/disparity_bits.hpp"
#include "stereo/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stereo/path_aggregation.cpp"
#include <hwy/foreach_target.h>

#include "stereo/disparity_lanes-inl.hpp"

#ifndef FLIGHT_CORRIDOR_PATH_AGGREGATION_ONCE
#define FLIGHT_CORRIDOR_PATH_AGGREGATION_ONCE
namespace flight_corridor {
namespace {

/// P2 of a step to a pixel, by the path.
struct Penalties {
  const std::uint8_t *level, *above, *above_left, *above_right;  // level: from the left; from the right is the next one
};

struct PathRow {
  int width_px, row;
  const std::uint8_t* costs;
  Penalties penalties;
  std::uint8_t *above, *above_left, *above_right, *sums;
};

}  // namespace
}  // namespace flight_corridor
#endif

HWY_BEFORE_NAMESPACE();
namespace flight_corridor {
namespace HWY_NAMESPACE {
namespace {

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

/// What a step of a path adds to C(p, d), before eq. 13 takes the minimum off.
/// @param before L(q, d).  @param neighbour the smaller of L(q, d -+ 1).  @param jump min L(q) + P2.
HWY_INLINE Vector stepped(Vector before, Vector neighbour, Vector jump) {
  const Vector small_step = hn::SaturatedAdd(neighbour, hn::Set(Bytes(), kSmallStepPenalty));
  return hn::Min(hn::Min(before, small_step), jump);
}

/// L of the next pixel of a path that runs along the row.
/// @param path L of the pixel before, changed.  @param least its minimum, changed.
template <int kVectors>
HWY_INLINE void stepAlong(const std::uint8_t* costs, std::uint8_t penalty, Curve<kVectors>& path, Vector& least) {
  const Vector jump = hn::SaturatedAdd(least, hn::Set(Bytes(), penalty));
  const Curve<kVectors> neighbour = smallerNeighbour(path);
  FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
    const Vector step = hn::SaturatedSub(stepped(path.part[k], neighbour.part[k], jump), least);
    path.part[k] = hn::SaturatedAdd(step, hn::Load(Bytes(), costs + k * kLanes));
  }
  least = smallest(path);
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

template <int kVectors>
HWY_INLINE void addTo(std::uint8_t* sums, const Curve<kVectors>& path, bool first) {
  if (first) return store(path, sums);
  FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
    const Vector sum = hn::SaturatedAdd(hn::Load(Bytes(), sums + k * kLanes), path.part[k]);
    hn::Store(sum, Bytes(), sums + k * kLanes);
  }
}

/// The paths from the left and from the right, side by side: each waits for its own minimum only.
template <int kVectors>
void sweepAlong(const PathRow& row) {
  constexpr int kStored = kVectors * kLanes;
  Curve<kVectors> from_left = filled<kVectors>(0), from_right = filled<kVectors>(0);
  Vector least_left = hn::Zero(Bytes()), least_right = least_left;
  for (int u = 0, mirrored_u = row.width_px - 1; u < row.width_px; ++u, --mirrored_u) {
    const std::size_t left_at = static_cast<std::size_t>(u) * kStored;
    const std::size_t right_at = static_cast<std::size_t>(mirrored_u) * kStored;
    stepAlong(row.costs + left_at, row.penalties.level[u], from_left, least_left);
    stepAlong(row.costs + right_at, row.penalties.level[mirrored_u + 1], from_right, least_right);
    addTo(row.sums + left_at, from_left, u <= mirrored_u);
    addTo(row.sums + right_at, from_right, u < mirrored_u);
  }
}

/// The three paths from above. An oblique one comes to pixel u from u -+ 1, and both keep its place in memory, which
/// is that of pixel u - row or u + row around the end of the row; one that comes in at a side begins anew.
template <int kVectors>
void sweepDown(const PathRow& row) {
  constexpr int kStored = kVectors * kLanes;
  const int width = row.width_px;
  int left_at = (width - row.row % width) % width, right_at = row.row % width;
  store(filled<kVectors>(0), row.above_left + static_cast<std::size_t>(left_at) * kStored);
  store(filled<kVectors>(0), row.above_right + static_cast<std::size_t>((right_at + width - 1) % width) * kStored);
  for (int u = 0; u < width; ++u) {
    const std::size_t at = static_cast<std::size_t>(u) * kStored;
    const Curve<kVectors> costs = load<kVectors>(row.costs + at);
    Curve<kVectors> sum = row.sums ? load<kVectors>(row.sums + at) : costs;
    stepDown(costs, row.penalties.above[u], row.above + at, sum);
    stepDown(costs, row.penalties.above_left[u], row.above_left + static_cast<std::size_t>(left_at) * kStored, sum);
    stepDown(costs, row.penalties.above_right[u], row.above_right + static_cast<std::size_t>(right_at) * kStored, sum);
    if (row.sums) store(sum, row.sums + at);
    if (++left_at == width) left_at = 0;
    if (++right_at == width) right_at = 0;
  }
}

void sweep(const PathRow& row, int stored_disparities) {
  withWords(stored_disparities / 64, [&row](auto words) {
    if (row.sums) sweepAlong<words * kVectorsOfWord>(row);
    sweepDown<words * kVectorsOfWord>(row);
  });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace flight_corridor
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flight_corridor {

HWY_EXPORT(penalties);
HWY_EXPORT(sweep);

namespace {

constexpr std::size_t kBefore = AlignedBytes::kAlignment;  // bytes before and behind a row: a vector reaches no farther

}  // namespace

PathAggregation::PathAggregation(int width_px, int stored_disparities)
    : width_px_(width_px),
      stored_(stored_disparities),
      above_(static_cast<std::size_t>(width_px) * stored_disparities),
      above_left_(static_cast<std::size_t>(width_px) * stored_disparities),
      above_right_(static_cast<std::size_t>(width_px) * stored_disparities),
      grey_(width_px + 2 * kBefore),
      grey_above_(width_px + 2 * kBefore),
      level_(width_px + kBefore) {
  for (AlignedBytes& penalties : from_above_) penalties = AlignedBytes(width_px + kBefore);
}

void PathAggregation::restart() {
  row_ = 0;
  for (AlignedBytes* paths : {&above_, &above_left_, &above_right_}) {
    std::memset(paths->data(), 0, static_cast<std::size_t>(width_px_) * stored_);
  }
}

/// P2 of each step. What is read beyond the ends belongs to steps that begin a path: there it has no effect.
void PathAggregation::takePenalties(const std::uint8_t* grey) {
  std::swap(grey_, grey_above_);
  std::memcpy(grey_.data() + kBefore, grey, width_px_);
  const std::uint8_t *row = grey_.data() + kBefore, *above = grey_above_.data() + kBefore;
  const auto penalties = HWY_DYNAMIC_DISPATCH(penalties);
  penalties(row, row - 1, width_px_ + 1, level_.data());
  penalties(row, above, width_px_, from_above_[0].data());
  penalties(row, above - 1, width_px_, from_above_[1].data());
  penalties(row, above + 1, width_px_, from_above_[2].data());
}

void PathAggregation::add(const std::uint8_t* costs, const std::uint8_t* grey, std::uint8_t* sums) {
  takePenalties(grey);
  const Penalties penalties{level_.data(), from_above_[0].data(), from_above_[1].data(), from_above_[2].data()};
  HWY_DYNAMIC_DISPATCH(sweep)
  ({width_px_, row_, costs, penalties, above_.data(), above_left_.data(), above_right_.data(), sums}, stored_);
  ++row_;
}

}  // namespace flight_corridor
#endif
