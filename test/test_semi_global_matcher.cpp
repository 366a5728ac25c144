// clang-format off
#include "stereo/targets.hpp"  // before Highway
// clang-format on

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <stdexcept>

#include "flight_corridor/stereo/semi_global_matcher.hpp"
#include "support/matcher_cases.hpp"

namespace {

std::atomic<long> allocations{0};

void* allocate(std::size_t size, std::size_t alignment) {
  ++allocations;
  void* const memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) { return allocate(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) { return allocate(size, std::size_t(alignment)); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

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
  SemiGlobalMatcher matcher(kBands, 2);
  Answers answers(kBands), again(kBands);
  matcher.match(second.leftView(), second.rightView(), answers.planes());
  Answers others(kBands);
  matcher.match(first.leftView(), first.rightView(), others.planes());
  matcher.match(second.leftView(), second.rightView(), again.planes());
  EXPECT_EQ(firstDifference(again, answers), "");
}

TEST(SemiGlobalMatcher, AllocatesNothingAfterConstruction) {
  const Pair pair = makePair(Scene::Surfaces, kBands, 6);
  for (const int threads : {1, 2}) {
    SemiGlobalMatcher matcher(kBands, threads);
    Answers answers(kBands);
    const MatchPlanes planes = answers.planes();
    const long before = allocations;
    for (int i = 0; i < 3; ++i) matcher.match(pair.leftView(), pair.rightView(), planes);
    EXPECT_EQ(allocations - before, 0) << threads;
  }
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
      EXPECT_NEAR(answers.best[v * pair.width + u] + kSize.min_disparity_px, kShift_px, 0.25) << u << " " << v;
    }
  }
}

TEST(SemiGlobalMatcher, RefusesTheImpossible) {
  EXPECT_THROW(SemiGlobalMatcher({1, 100, 0, 64}, 1), std::invalid_argument);
  EXPECT_THROW(SemiGlobalMatcher({100, 1, 0, 64}, 1), std::invalid_argument);
  EXPECT_THROW(SemiGlobalMatcher({100, 100, 0, 0}, 1), std::invalid_argument);
  EXPECT_THROW(SemiGlobalMatcher({100, 100, 0, 40}, 1), std::invalid_argument);
  EXPECT_THROW(SemiGlobalMatcher({100, 100, 0, 288}, 1), std::invalid_argument);
  EXPECT_THROW(SemiGlobalMatcher({100, 100, 0, 64}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace flight_corridor
