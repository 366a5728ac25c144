// Laws of the matcher's rules, on the slow and obvious one; test_semi_global_matcher.cpp holds the fast one to it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/matcher_cases.hpp"

namespace flight_corridor {
namespace {

using namespace matcher_cases;

TEST(MatchingCosts, DoNotChangeWithExposure) {
  constexpr MatcherSize kSize{70, 9, -2, 64};
  Pair pair = makePair(Scene::Noise, kSize, 2);
  for (std::uint8_t& grey : pair.left) grey = static_cast<std::uint8_t>(grey / 4 * 4);
  for (std::uint8_t& grey : pair.right) grey = static_cast<std::uint8_t>(grey / 4 * 4);
  const oracle::Volume before = oracle::costs(pair.leftView(), pair.rightView(), kSize);
  for (std::uint8_t& grey : pair.right) grey = static_cast<std::uint8_t>(grey / 2 + 90);  // steps of 4 become 2 still
  EXPECT_EQ(oracle::costs(pair.leftView(), pair.rightView(), kSize).values, before.values);
}

TEST(MatchingCosts, AreZeroWhereBothImagesAreTheSame) {
  constexpr MatcherSize kSize{70, 9, 0, 32};
  Pair pair = makePair(Scene::Noise, kSize, 3);
  pair.right = pair.left;
  const oracle::Volume costs = oracle::costs(pair.leftView(), pair.rightView(), kSize);
  for (int u = 0; u < kSize.width_px; ++u) EXPECT_EQ(costs.at(u, 4, 0), 0) << u;
}

TEST(Sums, FitIntoABytewhateverTheCosts) {
  constexpr MatcherSize kSize{40, 12, 0, 64};
  const std::vector<std::uint8_t> grey(kSize.width_px, 100);
  oracle::Volume costs(kSize, kCensusBits);
  for (int v = 0; v < kSize.height_px; ++v) {  // the best disparity is never the same
    for (int u = 0; u < kSize.width_px; ++u) costs.at(u, v, (u * 7 + v * 13) % kSize.num_disparities) = 0;
  }
  const oracle::Volume sums = oracle::sums({grey.data(), kSize.width_px, kSize.height_px, 0}, costs, 1);
  EXPECT_LE(*std::max_element(sums.values.begin(), sums.values.end()), 5 * (kCensusBits + kLargeStepPenalty));
  EXPECT_LT(5 * (kCensusBits + kLargeStepPenalty) + kContradiction, kNoDisparityCost);
}

TEST(Minimum, KeepsWhatTheImagesDoNotContradict) {
  oracle::Volume sums({60, 1, 0, 64}, 100);
  sums.at(50, 0, 20) = 30;
  sums.at(50, 0, 7) = sums.at(50, 0, 41) = 30 + kContradiction;
  sums.at(50, 0, 45) = 30 + kContradiction + 1;
  const oracle::Minimum minimum = oracle::minimumAt(sums, 50, 0);
  EXPECT_EQ(minimum.winner, 20);
  EXPECT_EQ(std::count(minimum.set.begin(), minimum.set.end(), true), 3);
  EXPECT_TRUE(minimum.set[7] && minimum.set[20] && minimum.set[41]);
}

TEST(Minimum, IsConsistentWhereNothingElseFitsTheRightPixelBetter) {
  oracle::Volume sums({60, 1, 0, 64}, 100);
  sums.at(50, 0, 40) = 10;  // on right pixel 10
  sums.at(20, 0, 10) = 20;  // on the same one
  EXPECT_EQ(oracle::minimumAt(sums, 50, 0).flags, kConsistent);
  EXPECT_EQ(oracle::minimumAt(sums, 20, 0).flags, 0);
}

/// Costs by disparity, of all pixels alike; the winner's is 2.
class Window : public testing::Test {
 protected:
  static constexpr MatcherSize kSize{200, 3, 0, 96};
  static constexpr int kMiddle_u = 150, kWinner = 30;

  void setAll(int cost) {
    costs_ = std::vector<int>(kSize.num_disparities, cost);
    costs_[kWinner] = 2;
  }
  oracle::Volume volume() const {
    oracle::Volume all(kSize, 0);
    for (std::size_t i = 0; i < all.values.size(); ++i) all.values[i] = costs_[i % costs_.size()];
    return all;
  }
  std::vector<int> competitors() const { return oracle::competitorsAt(volume(), kMiddle_u, 1, kWinner); }
  bool isDistinct(int u = kMiddle_u) const { return oracle::isDistinct(volume(), u, 1, kWinner); }

  std::vector<int> costs_;
};

TEST_F(Window, HasCompetitorsThatAreAsGoodBehindABarrier) {
  setAll(8);
  costs_[10] = costs_[70] = 2;
  EXPECT_EQ(competitors(), (std::vector<int>{10, 70}));
  costs_[70] = 3;  // ten tenths of a bit worse
  EXPECT_EQ(competitors(), (std::vector<int>{10}));
}

TEST_F(Window, HasNoneInTheSameValley) {
  setAll(4);  // 2 bits above
  costs_[70] = 2;
  EXPECT_EQ(competitors(), std::vector<int>());
}

TEST_F(Window, DistinguishesAWinnerFromHalfOfTheDisparities) {
  for (const int alike : {kSize.num_disparities / 2, kSize.num_disparities / 2 + 1}) {
    setAll(4);
    std::fill_n(costs_.begin(), alike, 2);
    EXPECT_EQ(isDistinct(), alike <= kSize.num_disparities / 2) << alike;
  }
}

TEST_F(Window, DistinguishesByMoreThanALittle) {
  for (const int above : {0, 2}) {  // bits a pixel
    setAll(2 + above);
    EXPECT_EQ(isDistinct(), above == 2) << above;
  }
}

TEST_F(Window, DistinguishesOnlyFromWhatTheRightCameraSees) {
  constexpr int kSeen = 41;  // disparities, at the pixel asked for
  for (const int alike : {kSeen / 2, kSeen / 2 + 1}) {
    setAll(4);
    std::fill_n(costs_.begin(), alike - 1, 2);
    EXPECT_EQ(isDistinct(kSeen - 1 + kWindowReach_px), alike <= kSeen / 2) << alike;
  }
}

TEST(SubpixelOffset, IsTheParabolasWhereTheWindowIsFlat) {
  EXPECT_EQ(oracle::subpixelOffset(20, 10, 20, {}), 0);
  EXPECT_EQ(oracle::subpixelOffset(10, 10, 20, {}), -kSubpixels / 2);
  EXPECT_EQ(oracle::subpixelOffset(20, 10, 10, {}), kSubpixels / 2);
  EXPECT_EQ(oracle::subpixelOffset(10, 10, 10, {}), 0);  // flat: anywhere
}

TEST(SubpixelOffset, ChangesSidesWithItsInputs) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const int least = static_cast<int>(random() % 50), below = least + static_cast<int>(random() % 60);
    const int above = least + static_cast<int>(random() % 60);
    oracle::Moments window, mirrored;
    window.gg = mirrored.gg = random() % 200000;
    window.ge = static_cast<int>(random() % 50000) - 25000;
    mirrored.ge = -window.ge;
    const int offset = oracle::subpixelOffset(below, least, above, window);
    EXPECT_EQ(oracle::subpixelOffset(above, least, below, mirrored), -offset) << i;
    EXPECT_LE(std::abs(offset), kSubpixels) << i;
  }
}

/// Waves, and the same moved by a disparity and exposed otherwise.
TEST(SubpixelOffset, HalvesTheErrorOfAParabolaThatIsDrawnToWholePixels) {
  constexpr int kDisparity_px = 20;
  constexpr MatcherSize kSize{200, 3, 0, 64};
  const auto grey = [](double u, int v) {
    return static_cast<std::uint8_t>(std::lround(100 + 40 * std::sin(u * 0.5 + v) + 30 * std::sin(u * 0.23 - 2 * v)));
  };
  for (const double error_px : {-0.4, -0.2, 0.0, 0.3}) {
    Pair pair(kSize);
    for (int v = 0; v < pair.height; ++v) {
      for (int u = 0; u < pair.width; ++u) {
        pair.left[v * pair.stride + u] = grey(u - kDisparity_px - error_px, v);
        pair.right[v * pair.stride + u] = static_cast<std::uint8_t>(grey(u, v) + 20);
      }
    }
    for (int u = 30; u + 10 < pair.width; ++u) {
      const oracle::Moments window = oracle::momentsAt(pair.leftView(), pair.rightView(), u, 1, kDisparity_px);
      const double found_px = oracle::subpixelOffset(90, 10, 90, window) / double{kSubpixels};  // symmetric: whole
      EXPECT_NEAR(found_px, error_px / 2, 0.06) << u;  // rounding of grey values over a gradient of some 15: 0.03
    }
  }
}

TEST(Average, IsOfOneSurfaceOnly) {
  constexpr int kWidth_px = 45, kHeight_px = 9;
  std::mt19937 random(2);
  std::vector<std::int16_t> fixed;
  for (int i = 0; i < kWidth_px * kHeight_px; ++i) {
    const int surface_px = i % kWidth_px < 20 ? 30 : 40,
              noise = static_cast<int>(random() % kSubpixels) - kSubpixels / 2;
    const bool none = random() % 5 == 0;
    fixed.push_back(static_cast<std::int16_t>(none ? kNoSubpixel : surface_px * kSubpixels + noise));
  }
  for (int i = 0; i < kWidth_px * kHeight_px; ++i) {
    if (fixed[i] == kNoSubpixel) continue;
    const int u = i % kWidth_px, v = i / kWidth_px;
    const double found_px =
        oracle::averageAt(fixed, kWidth_px, kHeight_px, u, v) / static_cast<double>(kSubpixels * kFineSteps);
    EXPECT_LE(std::abs(found_px - (u < 20 ? 30 : 40)), 0.5) << u << " " << v;
  }
}

}  // namespace
}  // namespace flight_corridor
