#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "flight_corridor/corridor/verdict.hpp"

namespace flight_corridor {
namespace {

TEST(Verdict, EveryReasonHasItsName) {
  const std::vector<std::pair<Reason, std::string>> names = {
      {kOccupiedCell, "OCCUPIED_CELL"},
      {kShortRange, "SHORT_RANGE"},
      {kUnobserved, "UNOBSERVED"},
      {kNoData, "NO_DATA"},
      {kNoPose, "NO_POSE"},
      {kBadImage, "BAD_IMAGE"},
      {kBadCalibration, "BAD_CALIBRATION"},
      {kNoDisparity, "NO_DISPARITY"},
      {kDisagreement, "DISAGREEMENT"},
      {kNoLidar, "NO_LIDAR"},
      {kLidarRejected, "LIDAR_REJECTED"},
      {kNoRangeObserved, "NO_RANGE_OBSERVED"},
      {kRecentlyBlocked, "RECENTLY_BLOCKED"},
      {kFrozenImage, "FROZEN_IMAGE"},
      {kAmbiguous, "AMBIGUOUS"},
      {kWeakEvidence, "WEAK_EVIDENCE"},
      {kLidarNearer, "LIDAR_NEARER"},
  };
  std::uint32_t reasons = 0;
  std::string all;
  for (const auto& [reason, name] : names) {
    EXPECT_EQ(describeReasons(reason), name);
    reasons |= reason;
    all += (all.empty() ? "" : "|") + name;
  }
  EXPECT_EQ(describeReasons(reasons), all);
  EXPECT_EQ(describeReasons(0), "");
  EXPECT_EQ(describeReasons(~reasons), "") << "a name of a reason that is not in the list";
}

TEST(Verdict, FreeIsWhatIsLeftWhenNoReasonForbidsIt) {
  constexpr std::uint32_t kBlocks = kOccupiedCell | kShortRange;
  constexpr std::uint32_t kHides = kUnobserved | kNoData | kNoPose | kBadImage | kBadCalibration | kNoDisparity |
                                   kRecentlyBlocked | kFrozenImage | kAmbiguous | kWeakEvidence | kLidarNearer;
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
