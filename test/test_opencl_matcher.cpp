// The matcher on an OpenCL device, held to the CPU's; skipped where there is no device. pocl is one.

#include <gtest/gtest.h>

#include <clocale>
#include <cstdlib>
#include <memory>
#include <random>
#include <thread>

#include "flight_corridor/opencl/opencl_matcher.hpp"
#include "flight_corridor/stereo/disparity_estimator.hpp"
#include "support/calibrations.hpp"
#include "support/matcher_cases.hpp"

namespace flight_corridor {
namespace {

using namespace matcher_cases;

const int kAnyDevice = setenv("OPENCV_OPENCL_DEVICE", ":", 0);  // before OpenCV asks

class OpenClMatcherTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!makeOpenClMatcher({70, 40, -2, 32})) GTEST_SKIP() << "no OpenCL device";
  }

  static Answers matchedByDevice(DeviceMatcher& matcher, const Pair& pair, const MatcherSize& size) {
    Answers answers(size);
    matcher.match(pair.leftView(), pair.rightView(), answers.planes());
    return answers;
  }
};

TEST_F(OpenClMatcherTest, EqualsTheCpuBitByBit) {
  for (const MatcherSize& size : sizes()) {
    const auto matcher = makeOpenClMatcher(size);
    for (const Scene scene : kScenes) {
      const Pair pair = makePair(scene, size, 1);
      EXPECT_EQ(firstDifference(matchedByDevice(*matcher, pair, size), matched(pair, size, 1)), "")
          << describe(scene, size);
    }
  }
}

TEST_F(OpenClMatcherTest, EqualsTheCpuForTwoHundredPairsOfAnySize) {
  std::mt19937 random(11);
  const auto any = [&random](int first, int last) { return first + static_cast<int>(random() % (last - first + 1)); };
  for (int i = 0; i < 10; ++i) {
    const MatcherSize size{any(2, 120), any(2, 150), any(-20, 20), 32 * any(1, 8), static_cast<float>(any(-9, 9)) / 4};
    const auto matcher = makeOpenClMatcher(size);
    for (unsigned seed = 0; seed < 20; ++seed) {
      const Scene scene = kScenes[seed % 4];
      const Pair pair = makePair(scene, size, 100 + seed);
      EXPECT_EQ(firstDifference(matchedByDevice(*matcher, pair, size), matched(pair, size, 1)), "")
          << describe(scene, size) << seed;
    }
  }
}

TEST_F(OpenClMatcherTest, TwoAtATimeDoNotDisturbEachOther) {
  constexpr MatcherSize kSize{90, 130, -2, 64};
  const auto fly = [&](unsigned seed) {
    const auto matcher = makeOpenClMatcher(kSize);
    for (unsigned i = 0; i < 10; ++i) {
      const Pair pair = makePair(Scene::Surfaces, kSize, seed + i);
      EXPECT_EQ(firstDifference(matchedByDevice(*matcher, pair, kSize), matched(pair, kSize, 1)), "") << seed + i;
    }
  };
  std::thread other(fly, 100);
  fly(200);
  other.join();
}

TEST_F(OpenClMatcherTest, ServesAnotherThreadThanTheOneThatMadeIt) {
  constexpr MatcherSize kSize{90, 40, -2, 64};
  const auto matcher = makeOpenClMatcher(kSize);
  const Pair pair = makePair(Scene::Surfaces, kSize, 3);
  Answers answers(kSize);
  std::thread([&] { answers = matchedByDevice(*matcher, pair, kSize); }).join();
  EXPECT_EQ(firstDifference(answers, matched(pair, kSize, 1)), "");
}

TEST_F(OpenClMatcherTest, ALocaleWithADecimalCommaChangesNothing) {
  constexpr MatcherSize kSize{70, 40, -2, 32, 0.375f};
  const char* const comma = std::setlocale(LC_NUMERIC, "de_DE.UTF-8");
  const auto matcher = makeOpenClMatcher(kSize);
  std::setlocale(LC_NUMERIC, "C");
  if (comma == nullptr) GTEST_SKIP() << "no such locale";
  const Pair pair = makePair(Scene::Surfaces, kSize, 3);
  EXPECT_EQ(firstDifference(matchedByDevice(*matcher, pair, kSize), matched(pair, kSize, 1)), "");
}

TEST_F(OpenClMatcherTest, APairOfAnotherSizeIsRefused) {
  const auto matcher = makeOpenClMatcher({70, 40, -2, 32});
  constexpr MatcherSize kOther{72, 40, -2, 32};
  EXPECT_THROW(matchedByDevice(*matcher, makePair(Scene::Noise, kOther, 1), kOther), DeviceError);
}

TEST_F(OpenClMatcherTest, ADeviceThatMatchesASampleAsTheCpuDoesIsTaken) {
  StereoConfig config;
  config.device = "gpu";
  EXPECT_NO_THROW(requireDevice(config, makeOpenClMatcher));
  const DisparityEstimator estimator(config, test_support::kSmallGeometry, 0.1, makeOpenClMatcher);
  EXPECT_EQ(estimator.device().failure, "");
  EXPECT_NE(estimator.device().name, "CPU");
}

TEST_F(OpenClMatcherTest, MoreMemoryThanThereIsIsRefused) {
  constexpr MatcherSize kSize{60000, 60000, 0, 256};  // 5 TB
  EXPECT_THROW(makeOpenClMatcher(kSize), DeviceError);
}

}  // namespace
}  // namespace flight_corridor
