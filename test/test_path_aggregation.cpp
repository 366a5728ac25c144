#include <gtest/gtest.h>

#include "flight_corridor/stereo/path_aggregation.hpp"
#include "support/matcher_cases.hpp"

namespace flight_corridor {
namespace {

using namespace matcher_cases;

/// Any costs, as stored; equal ones in the volume of the oracle.
class AnyCosts {
 public:
  AnyCosts(const MatcherSize& size, unsigned seed)
      : volume(size, 0),
        stored_(storedDisparities(size.num_disparities)),
        rows_(static_cast<std::size_t>(size.width_px) * size.height_px * stored_) {
    std::mt19937 random(seed);
    std::fill_n(rows_.data(), static_cast<std::size_t>(size.width_px) * size.height_px * stored_, kNoDisparityCost);
    for (int v = 0; v < size.height_px; ++v) {
      for (int u = 0; u < size.width_px; ++u) {
        for (int d = 0; d < size.num_disparities; ++d) {
          volume.at(u, v, d) = static_cast<int>(random() % (kCensusBits + 1));
          row(v)[static_cast<std::size_t>(u) * stored_ + d] = static_cast<std::uint8_t>(volume.at(u, v, d));
        }
      }
    }
  }

  std::uint8_t* row(int v) { return rows_.data() + static_cast<std::size_t>(v) * volume.size.width_px * stored_; }

  oracle::Volume volume;

 private:
  int stored_;
  AlignedBytes rows_;
};

/// How many sums differ from the slow ones, in the rows from first_v on.
int differing(PathAggregation& paths, AnyCosts& costs, const GreyImage& grey, int first_v) {
  const MatcherSize& size = costs.volume.size;
  const int stored = storedDisparities(size.num_disparities);
  oracle::Volume slow(size, 0);
  oracle::addBand(grey, costs.volume, 0, first_v, size.height_px, slow);
  AlignedBytes sums(static_cast<std::size_t>(size.width_px) * stored);
  int count = 0;
  paths.restart();
  for (int v = 0; v < size.height_px; ++v) {
    paths.add(costs.row(v), grey.row(v), v < first_v ? nullptr : sums.data());
    for (int u = 0; v >= first_v && u < size.width_px; ++u) {
      for (int d = 0; d < size.num_disparities; ++d) count += sums.data()[u * stored + d] != slow.at(u, v, d);
    }
  }
  return count;
}

TEST(PathAggregation, EqualsTheSlowOne) {
  for (const MatcherSize& size : sizes()) {
    AnyCosts costs(size, 1);
    const Pair pair = makePair(Scene::Stripes, size, 1);
    PathAggregation paths(size.width_px, storedDisparities(size.num_disparities));
    EXPECT_EQ(differing(paths, costs, pair.leftView(), 0), 0) << describe(Scene::Stripes, size);
    EXPECT_EQ(differing(paths, costs, pair.leftView(), size.height_px / 2), 0) << "begun before, a second time";
  }
}

TEST(PathAggregation, HasRoomForTheWorstCosts) {
  constexpr int kWidth_px = 40, kRows = 12, kStored = kDisparityStep;
  AlignedBytes costs(kWidth_px * kStored), sums(kWidth_px * kStored);
  const std::vector<std::uint8_t> grey(kWidth_px, 100);
  PathAggregation paths(kWidth_px, kStored);
  for (int v = 0; v < kRows; ++v) {
    std::fill_n(costs.data(), kWidth_px * kStored, static_cast<std::uint8_t>(kCensusBits));
    for (int u = 0; u < kWidth_px; ++u) costs.data()[u * kStored + (u * 7 + v * 13) % kStored] = 0;  // never the same
    paths.add(costs.data(), grey.data(), sums.data());
  }
  EXPECT_LE(*std::max_element(sums.data(), sums.data() + kWidth_px * kStored), 5 * (kCensusBits + kLargeStepPenalty));
}

}  // namespace
}  // namespace flight_corridor
