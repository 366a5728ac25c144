#include <gtest/gtest.h>

#include <stdexcept>

#include "flight_corridor/pipeline.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {
namespace {

TEST(Types, ReasonsAreNamedInTheOrderOfTheirBits) {
  EXPECT_EQ(describeReasons(0), "");
  EXPECT_EQ(describeReasons(kOccupiedCell | kDisagreement), "OCCUPIED_CELL|DISAGREEMENT");
  EXPECT_EQ(describeReasons(kNoRangeObserved), "NO_RANGE_OBSERVED");
  EXPECT_EQ(describeReasons(kRecentlyBlocked), "RECENTLY_BLOCKED");
  EXPECT_EQ(describeReasons(kFrozenImage), "FROZEN_IMAGE");
  EXPECT_EQ(describeReasons(kUnmatched), "UNMATCHED");
}

TEST(Types, FreeIsWhatIsLeftWhenNoReasonForbidsIt) {
  constexpr std::uint32_t kBlocks = kOccupiedCell | kShortRange;
  constexpr std::uint32_t kHides = kUnobserved | kNoData | kNoPose | kBadImage | kBadCalibration | kNoDisparity |
                                   kRecentlyBlocked | kFrozenImage | kUnmatched;
  for (std::uint32_t reasons = 0; reasons < 2 * kUnmatched; ++reasons) {
    const State expected = reasons & kBlocks ? State::Blocked : reasons & kHides ? State::Unknown : State::Free;
    ASSERT_EQ(stateOf(reasons), expected) << describeReasons(reasons);
  }
}

TEST(Types, AReasonThatNobodyKnowsIsNotFree) { EXPECT_EQ(stateOf(2 * kUnmatched), State::Unknown); }

TEST(Types, AFreshVerdictIsUnknown) {
  EXPECT_EQ(Verdict().state, State::Unknown);
  EXPECT_STREQ(toString(Verdict().state), "UNKNOWN");
}

TEST(Config, DefaultsBreakNoRule) { EXPECT_TRUE(check(Config()).empty()); }

TEST(Config, EveryBrokenRuleIsReportedAtOnceWithKeyAndValue) {
  Config config;
  config.corridor.width_m = -1.0;
  config.stereo.block_size_px = 4;
  config.map.resolution_m = kNaN;
  try {
    throwIfBroken(check(config));
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("corridor/width_m"), std::string::npos);
    EXPECT_NE(text.find("(-1)"), std::string::npos);
    EXPECT_NE(text.find("stereo/block_size_px"), std::string::npos);
    EXPECT_NE(text.find("map/resolution_m"), std::string::npos);
  }
}

TEST(Config, AMapThatEndsBeforeTheCorridorIsRefused) {
  Config config;
  config.map.max_range_m = 3.0;
  ASSERT_EQ(check(config).size(), 1u);
  EXPECT_NE(check(config).front().find("map/max_range_m"), std::string::npos);
}

}  // namespace
}  // namespace flight_corridor
