#include <gtest/gtest.h>

#include "flight_corridor/stereo/distinct_competitor.hpp"
#include "support/matcher_cases.hpp"

namespace flight_corridor {
namespace {

using namespace matcher_cases;

constexpr MatcherSize kRow{200, 3, 0, 96};
constexpr int kMiddle_u = 150, kWinner = 30;

/// Cost by disparity, of all pixels alike.
struct Curve {
  explicit Curve(int cost) : costs(kRow.num_disparities, cost) {}
  std::vector<int> costs;
};

struct Found {
  int flags = 0, farthest = 0, nearest = 0;
};

Found find(const Curve& curve, int u = kMiddle_u) {
  const int stored = storedDisparities(kRow.num_disparities);
  AlignedBytes row(static_cast<std::size_t>(kRow.width_px) * stored);
  for (int u = 0; u < kRow.width_px; ++u) {
    for (int d = 0; d < stored; ++d) {
      row.data()[u * stored + d] =
          d < kRow.num_disparities ? static_cast<std::uint8_t>(curve.costs[d]) : kNoDisparityCost;
    }
  }
  const std::vector<std::uint8_t> winner(kRow.width_px, kWinner);
  std::vector<std::uint8_t> farthest(kRow.width_px), nearest(kRow.width_px), flags(kRow.width_px);
  DistinctCompetitor(kRow.width_px, kRow.min_disparity_px, kRow.num_disparities)
      .find({row.data(), row.data(), row.data()}, winner.data(), {farthest.data(), nearest.data(), flags.data()});
  return {flags[u], farthest[u], nearest[u]};
}

TEST(DistinctCompetitor, IsAsGoodAndBehindABarrier) {
  Curve curve(8);
  curve.costs[kWinner] = curve.costs[10] = curve.costs[70] = 2;
  const Found found = find(curve);
  EXPECT_EQ(found.flags, kCompetitor | kDistinct);
  EXPECT_EQ(found.farthest, 10);
  EXPECT_EQ(found.nearest, 70);
}

TEST(DistinctCompetitor, MayBeOnOneSideOnly) {
  Curve curve(8);
  curve.costs[kWinner] = curve.costs[70] = curve.costs[80] = 2;
  const Found found = find(curve);
  EXPECT_EQ(found.flags, kCompetitor | kDistinct);
  EXPECT_EQ(found.farthest, 70);
  EXPECT_EQ(found.nearest, 80);
}

TEST(DistinctCompetitor, IsNotAWorseOne) {
  Curve curve(8);
  curve.costs[kWinner] = 2;
  curve.costs[70] = 3;  // ten tenths of a bit worse
  EXPECT_EQ(find(curve).flags, kDistinct);
}

TEST(DistinctCompetitor, IsNotTheSameValleyWithoutABarrier) {
  Curve curve(4);  // 2 bits above
  curve.costs[kWinner] = curve.costs[70] = 2;
  EXPECT_EQ(find(curve).flags, kDistinct);
}

TEST(DistinctCompetitor, DistinguishesAWinnerFromHalfOfTheDisparities) {
  for (const int alike : {kRow.num_disparities / 2, kRow.num_disparities / 2 + 1}) {
    Curve curve(4);  // 2 bits above
    for (int d = 0; d < alike; ++d) curve.costs[d] = 2;
    EXPECT_EQ(find(curve).flags, alike <= kRow.num_disparities / 2 ? kDistinct : 0) << alike;
  }
}

TEST(DistinctCompetitor, DistinguishesByMoreThanALittle) {
  for (const int above : {0, 1, 2}) {  // bits a pixel; of the window's halved sum 0, 7 and 21
    Curve curve(2 + above);
    curve.costs[kWinner] = 2;
    EXPECT_EQ(find(curve).flags, above == 2 ? kDistinct : 0) << above;
  }
}

TEST(DistinctCompetitor, DistinguishesOnlyFromWhatTheRightCameraSees) {
  constexpr int kSeen = 41;  // disparities, at the pixel asked for
  for (const int alike : {kSeen / 2, kSeen / 2 + 1}) {
    Curve curve(4);
    for (int d = 0; d + 1 < alike; ++d) curve.costs[d] = 2;
    curve.costs[kWinner] = 2;
    EXPECT_EQ(find(curve, kSeen - 1 + DistinctCompetitor::kReach_px).flags, alike <= kSeen / 2 ? kDistinct : 0)
        << alike;
  }
}

TEST(DistinctCompetitor, EqualsTheSlowOne) {
  for (const MatcherSize& size : sizes()) {
    const Pair pair = makePair(Scene::Stripes, size, 9);
    EXPECT_EQ(firstDifference(matched(pair, size, 1), matchedSlowly(pair, size)), "") << describe(Scene::Stripes, size);
  }
}

}  // namespace
}  // namespace flight_corridor
