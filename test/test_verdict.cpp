#include <gtest/gtest.h>

#include "flight_corridor/corridor/verdict.hpp"

namespace flight_corridor {
namespace {

TEST(Verdict, ReasonsAreNamedInTheOrderOfTheirBits) {
  EXPECT_EQ(describeReasons(0), "");
  EXPECT_EQ(describeReasons(kOccupiedCell | kDisagreement), "OCCUPIED_CELL|DISAGREEMENT");
  EXPECT_EQ(describeReasons(kNoRangeObserved), "NO_RANGE_OBSERVED");
  EXPECT_EQ(describeReasons(kRecentlyBlocked), "RECENTLY_BLOCKED");
  EXPECT_EQ(describeReasons(kFrozenImage), "FROZEN_IMAGE");
  EXPECT_EQ(describeReasons(kUnmatched), "UNMATCHED");
  EXPECT_EQ(describeReasons(kOutline | kLidarNearer), "OUTLINE|LIDAR_NEARER");
}

TEST(Verdict, FreeIsWhatIsLeftWhenNoReasonForbidsIt) {
  constexpr std::uint32_t kBlocks = kOccupiedCell | kShortRange;
  constexpr std::uint32_t kHides = kUnobserved | kNoData | kNoPose | kBadImage | kBadCalibration | kNoDisparity |
                                   kRecentlyBlocked | kFrozenImage | kUnmatched | kOutline | kLidarNearer;
  for (std::uint32_t reasons = 0; reasons < 2 * kLidarNearer; ++reasons) {
    const State expected = reasons & kBlocks ? State::Blocked : reasons & kHides ? State::Unknown : State::Free;
    ASSERT_EQ(stateOf(reasons), expected) << describeReasons(reasons);
  }
}

TEST(Verdict, AReasonThatNobodyKnowsIsNotFree) { EXPECT_EQ(stateOf(2 * kLidarNearer), State::Unknown); }

TEST(Verdict, AFreshVerdictIsUnknown) {
  EXPECT_EQ(Verdict().state, State::Unknown);
  EXPECT_STREQ(toString(Verdict().state), "UNKNOWN");
}

}  // namespace
}  // namespace flight_corridor
