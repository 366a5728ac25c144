#include <gtest/gtest.h>

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
                                   kRecentlyBlocked | kFrozenImage | kUnmatched | kOutline;
  for (std::uint32_t reasons = 0; reasons < 2 * kOutline; ++reasons) {
    const State expected = reasons & kBlocks ? State::Blocked : reasons & kHides ? State::Unknown : State::Free;
    ASSERT_EQ(stateOf(reasons), expected) << describeReasons(reasons);
  }
}

TEST(Types, AReasonThatNobodyKnowsIsNotFree) { EXPECT_EQ(stateOf(2 * kUnmatched), State::Unknown); }

TEST(Types, AFreshVerdictIsUnknown) {
  EXPECT_EQ(Verdict().state, State::Unknown);
  EXPECT_STREQ(toString(Verdict().state), "UNKNOWN");
}

}  // namespace
}  // namespace flight_corridor
