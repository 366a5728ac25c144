#include <gtest/gtest.h>

#include "flight_corridor/stereo/cost_minima.hpp"
#include "support/matcher_cases.hpp"

namespace flight_corridor {
namespace {

using namespace matcher_cases;

/// A row's sums, all alike at first, and what is found in them.
class Row {
 public:
  explicit Row(const MatcherSize& size, int sum = 100)
      : volume(size, sum),
        winner(size.width_px),
        farthest(size.width_px),
        nearest(size.width_px),
        flags(size.width_px) {}

  void find() {
    const MatcherSize& size = volume.size;
    const int stored = storedDisparities(size.num_disparities);
    AlignedBytes sums(static_cast<std::size_t>(size.width_px) * stored);
    std::fill_n(sums.data(), static_cast<std::size_t>(size.width_px) * stored, std::uint8_t{255});
    for (int u = 0; u < size.width_px; ++u) {
      for (int d = 0; d < size.num_disparities; ++d) {
        sums.data()[u * stored + d] = static_cast<std::uint8_t>(volume.at(u, 0, d));
      }
    }
    set.resize(static_cast<std::size_t>(size.width_px) * stored / 64);
    CostMinima(size.width_px, size.min_disparity_px, size.num_disparities)
        .find(sums.data(), {winner.data(), farthest.data(), nearest.data(), flags.data(), set.data()});
  }

  oracle::Volume volume;
  std::vector<std::uint8_t> winner, farthest, nearest, flags;
  std::vector<std::uint64_t> set;
};

TEST(CostMinima, EqualTheSlowOnes) {
  for (MatcherSize size : sizes()) {
    size.height_px = 1;
    Row row(size);
    std::mt19937 random(1);
    for (int& sum : row.volume.values) sum = static_cast<int>(random() % 181);
    row.find();
    for (int u = 0; u < size.width_px; ++u) {
      const oracle::Minimum slow = oracle::minimumAt(row.volume, u, 0);
      EXPECT_EQ(row.winner[u], slow.winner) << u;
      EXPECT_EQ(row.farthest[u], slow.farthest) << u;
      EXPECT_EQ(row.nearest[u], slow.nearest) << u;
      EXPECT_EQ(row.flags[u], slow.flags) << u;
      for (int d = 0; d < size.num_disparities; ++d) {
        const std::size_t word = static_cast<std::size_t>(u) * (storedDisparities(size.num_disparities) / 64) + d / 64;
        EXPECT_EQ(row.set[word] >> d % 64 & 1, slow.set[d]) << u << " " << d;
      }
    }
  }
}

TEST(CostMinima, BoundWhatTheImagesDoNotContradict) {
  Row row({60, 1, 0, 64});
  row.volume.at(50, 0, 20) = 30;
  row.volume.at(50, 0, 7) = 30 + kContradiction;
  row.volume.at(50, 0, 41) = 30 + kContradiction;
  row.volume.at(50, 0, 45) = 30 + kContradiction + 1;
  row.find();
  EXPECT_EQ(row.winner[50], 20);
  EXPECT_EQ(row.farthest[50], 7);
  EXPECT_EQ(row.nearest[50], 41);
}

TEST(CostMinima, CallHiddenWhatSomethingNearerHides) {
  Row row({60, 1, 0, 64});
  row.volume.at(50, 0, 40) = 10;  // near: on right pixel 10
  row.volume.at(20, 0, 10) = 20;  // far, and on the same right pixel
  row.find();
  EXPECT_EQ(row.flags[50], kConsistent);
  EXPECT_EQ(row.flags[20], kHidden);
}

TEST(CostMinima, CallNothingHiddenByWhatIsFarther) {
  Row row({60, 1, 0, 64});
  row.volume.at(50, 0, 40) = 20;
  row.volume.at(20, 0, 10) = 10;
  row.find();
  EXPECT_EQ(row.flags[50], 0);
  EXPECT_EQ(row.flags[20], kConsistent);
}

}  // namespace
}  // namespace flight_corridor
