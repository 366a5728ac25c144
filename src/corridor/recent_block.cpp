#include "flight_corridor/corridor/recent_block.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr double kLarge_m2 = 0.035;    // shown of a patch in and near the box: a smaller one the next image may lose
constexpr double kSamePlace_m = 0.15;  // so far apart a verdict's distance and a patch's beginning are of one obstacle

}  // namespace

void RecentBlock::onBlocked(const Verdict& verdict, const std::vector<BoxPatch>& patches, double smallest_m) {
  blocked_s_ = verdict.stamp_s;
  bool is_shown = false;
  for (const BoxPatch& patch : patches) {
    if (!patch.blocks(smallest_m * smallest_m)) continue;
    is_shown |= std::abs(patch.begin_m - verdict.clear_distance_m) <= kSamePlace_m;
    if (patch.around_m2 < kLarge_m2) missable_s_ = verdict.stamp_s;
    if (patch.in_middle_m2 < kLarge_m2) edge_s_ = verdict.stamp_s;
  }
  if (!is_shown) missable_s_ = verdict.stamp_s;
}

bool RecentBlock::mayRemain(double stamp_s, const std::vector<BoxPatch>& patches, double smallest_m) const {
  const auto is_recent = [&](double blocked_s) { return std::abs(stamp_s - blocked_s) <= hold_s_; };
  const bool is_beside = std::any_of(patches.begin(), patches.end(), [&](const BoxPatch& patch) {
    return patch.around_m2 >= 0.5 * smallest_m * smallest_m;
  });
  return is_recent(missable_s_) || (is_recent(edge_s_) && is_beside);
}

}  // namespace flight_corridor
