#include <gtest/gtest.h>

#include "flight_corridor/stereo/census.hpp"
#include "support/matcher_cases.hpp"

namespace flight_corridor {
namespace {

using namespace matcher_cases;

/// All costs of a pair, padding included.
std::vector<std::uint8_t> costsOf(const Pair& pair, const MatcherSize& size) {
  const std::size_t row = static_cast<std::size_t>(size.width_px) * storedDisparities(size.num_disparities);
  CensusCosts census(size.width_px, size.min_disparity_px, size.num_disparities);
  AlignedBytes costs(row);
  std::vector<std::uint8_t> all;
  for (int v = 0; v < size.height_px; ++v) {
    census.compute(pair.leftView(), pair.rightView(), v, costs.data());
    all.insert(all.end(), costs.data(), costs.data() + row);
  }
  return all;
}

TEST(CensusCosts, EqualTheSlowOnes) {
  for (const MatcherSize& size : sizes()) {
    const Pair pair = makePair(Scene::Surfaces, size, 1);
    const std::vector<std::uint8_t> costs = costsOf(pair, size);
    const oracle::Volume slow = oracle::costs(pair.leftView(), pair.rightView(), size);
    std::size_t at = 0, differing = 0;
    for (int v = 0; v < size.height_px; ++v) {
      for (int u = 0; u < size.width_px; ++u) {
        for (int d = 0; d < storedDisparities(size.num_disparities); ++d, ++at) {
          differing += costs[at] != (d < size.num_disparities ? slow.at(u, v, d) : kNoDisparityCost);
        }
      }
    }
    EXPECT_EQ(differing, 0u) << describe(Scene::Surfaces, size);
  }
}

TEST(CensusCosts, DoNotChangeWithExposure) {
  constexpr MatcherSize kSize{70, 9, -2, 64};
  Pair pair = makePair(Scene::Noise, kSize, 2);
  for (std::uint8_t& grey : pair.left) grey = static_cast<std::uint8_t>(grey / 4 * 4);
  for (std::uint8_t& grey : pair.right) grey = static_cast<std::uint8_t>(grey / 4 * 4);
  const std::vector<std::uint8_t> before = costsOf(pair, kSize);
  for (std::uint8_t& grey : pair.right) grey = static_cast<std::uint8_t>(grey / 2 + 90);  // steps of 4 become 2 still
  EXPECT_EQ(costsOf(pair, kSize), before);
}

TEST(CensusCosts, AreZeroWhereBothImagesAreTheSame) {
  constexpr MatcherSize kSize{70, 9, 0, 32};
  Pair pair = makePair(Scene::Noise, kSize, 3);
  pair.right = pair.left;
  const std::vector<std::uint8_t> costs = costsOf(pair, kSize);
  for (std::size_t at = 0; at < costs.size(); at += kDisparityStep) EXPECT_EQ(costs[at], 0) << at;
}

}  // namespace
}  // namespace flight_corridor
