// clang-format off
#include "stereo/targets.hpp"  // before Highway
// clang-format on

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <stdexcept>

#include "flight_corridor/stereo/semi_global_matcher.hpp"
#include "support/matcher_cases.hpp"

namespace flight_corridor {
namespace {

using namespace matcher_cases;

constexpr MatcherSize kBands{61, 250, -2, 96};  // three of them, the middle one with others on both sides

TEST(SemiGlobalMatcher, EqualsTheSlowOneBitByBit) {
  for (const MatcherSize& size : sizes()) {
    for (const Scene scene : kScenes) {
      const Pair pair = makePair(scene, size, 1);
      EXPECT_EQ(firstDifference(matched(pair, size, 1), matchedSlowly(pair, size)), "") << describe(scene, size);
    }
  }
}

#if (HWY_TARGETS & (HWY_TARGETS - 1)) != 0  // more than one
TEST(SemiGlobalMatcher, AnswersTheSameWhateverTheInstructionSet) {
  for (const MatcherSize& size : sizes()) {
    for (const Scene scene : kScenes) {
      const Pair pair = makePair(scene, size, 2);
      const Answers usual = matched(pair, size, 1);
      for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        EXPECT_EQ(firstDifference(matched(pair, size, 1), usual), "")
            << describe(scene, size) << hwy::TargetName(target);
      }
      hwy::SetSupportedTargetsForTest(0);
    }
  }
}
#endif

TEST(SemiGlobalMatcher, AnswersTheSameWhateverTheNumberOfThreads) {
  for (const Scene scene : kScenes) {
    const Pair pair = makePair(scene, kBands, 3);
    const Answers alone = matched(pair, kBands, 1);
    for (const int threads : {2, 3, 8}) {
      EXPECT_EQ(firstDifference(matched(pair, kBands, threads), alone), "") << threads;
    }
  }
}

TEST(SemiGlobalMatcher, RemembersNothingOfThePairBefore) {
  const Pair first = makePair(Scene::Noise, kBands, 4), second = makePair(Scene::Surfaces, kBands, 5);
  BandWorkers workers(2);
  SemiGlobalMatcher matcher(kBands, workers);
  Answers answers(kBands), again(kBands);
  matcher.match(second.leftView(), second.rightView(), answers.planes());
  Answers others(kBands);
  matcher.match(first.leftView(), first.rightView(), others.planes());
  matcher.match(second.leftView(), second.rightView(), again.planes());
  EXPECT_EQ(firstDifference(again, answers), "");
}

TEST(SemiGlobalMatcher, FindsAShiftedTexture) {
  constexpr MatcherSize kSize{160, 40, -3, 64};
  constexpr int kShift_px = 17;
  Pair pair = makePair(Scene::Noise, kSize, 7);
  for (int v = 0; v < pair.height; ++v) {
    for (int u = 0; u + kShift_px < pair.width; ++u) {
      pair.right[v * pair.stride + u] = pair.left[v * pair.stride + u + kShift_px];
    }
  }
  const Answers answers = matched(pair, kSize, 1);
  for (int v = 0; v < pair.height; ++v) {
    for (int u = kShift_px + 4; u + 4 < pair.width; ++u) {  // the census's window lies in both images
      EXPECT_NEAR(answers.best[v * pair.width + u], kShift_px, 0.25) << u << " " << v;
    }
  }
}

/// A run-up forgets most of what the rows before it would have told: one path in a thousand remembers longer.
TEST(SemiGlobalMatcher, ShowsTheSeamsOfItsBandsInAThousandthOfTheMatchesAtMost) {
  int matches = 0, differing = 0;
  for (const unsigned seed : {8u, 9u, 10u}) {
    const Pair pair = makePair(Scene::Surfaces, kBands, seed);
    const Answers banded = matchedSlowly(pair, kBands), whole = matchedSlowly(pair, kBands, 1);
    for (std::size_t i = 0; i < whole.pixels; ++i) {
      const bool is_match = !std::isnan(whole.best[i]);
      matches += is_match;
      differing += is_match == std::isnan(banded.best[i]) || std::abs(whole.best[i] - banded.best[i]) > 0.5f;
    }
  }
  EXPECT_GT(matches, 10000);
  EXPECT_LE(1000 * differing, matches);
}

TEST(SemiGlobalMatcher, RefusesTheImpossible) {
  BandWorkers workers(1);
  for (const MatcherSize& size : {MatcherSize{1, 100, 0, 64}, MatcherSize{100, 1, 0, 64}, MatcherSize{100, 100, 0, 0},
                                  MatcherSize{100, 100, 0, 40}, MatcherSize{100, 100, 0, 288}}) {
    EXPECT_THROW(SemiGlobalMatcher(size, workers), std::invalid_argument);
  }
}

}  // namespace
}  // namespace flight_corridor
