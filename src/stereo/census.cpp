#include "flight_corridor/stereo/census.hpp"

#include <algorithm>
#include <cstring>

#include "flight_corridor/stereo/disparity_bits.hpp"
#include "stereo/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stereo/census.cpp"
#include <hwy/foreach_target.h>

#include "stereo/disparity_lanes-inl.hpp"

#ifndef FLIGHT_CORRIDOR_CENSUS_ONCE
#define FLIGHT_CORRIDOR_CENSUS_ONCE
namespace flight_corridor {
namespace {

constexpr int kReach_px = 4;  // of the window along the row

/// What the vector code needs of one row.
struct CostRow {
  int width_px, min_disparity_px, num_disparities;
  const std::uint8_t* left_codes[2];
  const std::uint8_t* mirrored[2];
  const std::uint8_t* unseen;
  std::uint8_t* costs;
};

}  // namespace
}  // namespace flight_corridor
#endif

HWY_BEFORE_NAMESPACE();
namespace flight_corridor {
namespace HWY_NAMESPACE {
namespace {

/// bit where a pixel is brighter than another by more than one grey level, which noise and rounding make of nothing.
HWY_INLINE Vector brighter(const std::uint8_t* one, const std::uint8_t* other, int bit) {
  const Bytes bytes;
  const Vector excess = hn::SaturatedSub(hn::LoadU(bytes, one), hn::LoadU(bytes, other));
  return hn::IfThenElseZero(hn::Gt(excess, hn::Set(bytes, 1)), hn::Set(bytes, static_cast<std::uint8_t>(1u << bit)));
}

/// @param above, middle, below pixels of three rows with kReach_px more at the ends.
void censusCodes(const std::uint8_t* above, const std::uint8_t* middle, const std::uint8_t* below, int width_px,
                 std::uint8_t* low, std::uint8_t* high) {
  const Bytes bytes;
  for (int u = 0; u < width_px; u += kLanes) {
    const std::uint8_t *a = above + kReach_px + u, *m = middle + kReach_px + u, *b = below + kReach_px + u;
    Vector codes[2] = {hn::Zero(bytes), hn::Zero(bytes)};
    int bit = 0;
    const auto add = [&](const std::uint8_t* one, const std::uint8_t* other) HWY_ATTR {
      codes[bit / 8] = hn::Or(codes[bit / 8], brighter(one, other, bit % 8));
      ++bit;
    };
    FLIGHT_CORRIDOR_UNROLL for (int du = -kReach_px; du <= kReach_px; ++du) add(a + du, b - du);
    FLIGHT_CORRIDOR_UNROLL for (int du = 1; du <= kReach_px; ++du) add(m - du, m + du);
    FLIGHT_CORRIDOR_UNROLL for (int du = -1; du <= 1; ++du) add(a + du, m);
    hn::StoreU(codes[0], bytes, low + u);
    hn::StoreU(codes[1], bytes, high + u);
  }
}

HWY_INLINE Vector hammingDistance(const CostRow& row, const Vector (&left)[2], int mirrored_u) {
  const Bytes bytes;
  return hn::Add(hn::PopulationCount(hn::Xor(left[0], hn::LoadU(bytes, row.mirrored[0] + mirrored_u))),
                 hn::PopulationCount(hn::Xor(left[1], hn::LoadU(bytes, row.mirrored[1] + mirrored_u))));
}

template <int kVectors>
void costsOf(const CostRow& row) {
  const Bytes bytes;
  const int last_px = row.min_disparity_px + row.num_disparities - 1;
  const int first_whole_u = row.num_disparities % kDisparityStep == 0 ? last_px : row.width_px;
  const int last_whole_u = std::min(row.width_px, row.width_px + row.min_disparity_px) - 1;
  std::uint8_t* costs = row.costs;
  for (int u = 0; u < row.width_px; ++u, costs += kVectors * kLanes) {
    const Vector left[2] = {hn::Set(bytes, row.left_codes[0][u]), hn::Set(bytes, row.left_codes[1][u])};
    const int mirrored_u = row.width_px - 1 - u;
    FLIGHT_CORRIDOR_UNROLL for (int k = 0; k < kVectors; ++k) {
      hn::Store(hammingDistance(row, left, mirrored_u + k * kLanes), bytes, costs + k * kLanes);
    }
    if (first_whole_u <= u && u <= last_whole_u) continue;
    const Vector first = hn::Set(bytes, kUnseenCost);
    for (int k = 0; k < kVectors; ++k) {
      const auto unseen = hn::Ne(hn::LoadU(bytes, row.unseen + mirrored_u + k * kLanes), hn::Zero(bytes));
      hn::Store(hn::IfThenElse(unseen, first, hn::Load(bytes, costs + k * kLanes)), bytes, costs + k * kLanes);
    }
    std::memset(costs + row.num_disparities, kNoDisparityCost, kVectors * kLanes - row.num_disparities);
  }
}

void costs(const CostRow& row) {
  withWords(storedDisparities(row.num_disparities) / 64, [&row](auto words) { costsOf<words * kVectorsOfWord>(row); });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace flight_corridor
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flight_corridor {

HWY_EXPORT(censusCodes);
HWY_EXPORT(costs);

CensusCosts::CensusCosts(int width_px, int min_disparity_px, int num_disparities)
    : width_px_(width_px),
      min_disparity_px_(min_disparity_px),
      num_disparities_(num_disparities),
      stored_(storedDisparities(num_disparities)) {
  for (AlignedBytes& row : rows_) row = AlignedBytes(width_px + 2 * kReach_px + AlignedBytes::kAlignment);
  for (AlignedBytes& codes : left_codes_) codes = AlignedBytes(width_px + AlignedBytes::kAlignment);
  for (AlignedBytes& codes : right_codes_) codes = AlignedBytes(width_px + AlignedBytes::kAlignment);
  for (AlignedBytes& codes : mirrored_) codes = AlignedBytes(width_px + stored_);
  unseen_ = AlignedBytes(width_px + stored_);
  for (int i = 0; i < width_px + stored_; ++i) {
    const int u_right = width_px - 1 - i - min_disparity_px;
    unseen_.data()[i] = 0 <= u_right && u_right < width_px ? 0 : 255;
  }
}

void CensusCosts::pad(const GreyImage& image, int v) {
  for (int dv = -1; dv <= 1; ++dv) {
    const std::uint8_t* from = image.row(std::clamp(v + dv, 0, image.height - 1));
    std::uint8_t* to = rows_[dv + 1].data();
    std::memset(to, from[0], kReach_px);
    std::memcpy(to + kReach_px, from, width_px_);
    std::memset(to + kReach_px + width_px_, from[width_px_ - 1], kReach_px);
  }
}

void CensusCosts::compute(const GreyImage& left, const GreyImage& right, int v, std::uint8_t* costs_out) {
  const auto codes = HWY_DYNAMIC_DISPATCH(censusCodes);
  pad(left, v);
  codes(rows_[0].data(), rows_[1].data(), rows_[2].data(), width_px_, left_codes_[0].data(), left_codes_[1].data());
  pad(right, v);
  codes(rows_[0].data(), rows_[1].data(), rows_[2].data(), width_px_, right_codes_[0].data(), right_codes_[1].data());
  const int first = std::max(0, -min_disparity_px_),
            last = std::min(width_px_ + stored_, width_px_ - min_disparity_px_);
  for (int part = 0; part < 2; ++part) {
    std::uint8_t* mirrored = mirrored_[part].data();
    const std::uint8_t* last_code = right_codes_[part].data() + width_px_ - 1 - min_disparity_px_;
    for (int i = first; i < last; ++i) mirrored[i] = last_code[-i];
  }
  HWY_DYNAMIC_DISPATCH(costs)
  ({width_px_,
    min_disparity_px_,
    num_disparities_,
    {left_codes_[0].data(), left_codes_[1].data()},
    {mirrored_[0].data(), mirrored_[1].data()},
    unseen_.data(),
    costs_out});
}

}  // namespace flight_corridor
#endif
