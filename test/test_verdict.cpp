#include <gtest/gtest.h>

#include <cmath>
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
      {kMoving, "MOVING"},
      {kNoMotion, "NO_MOTION"},
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
  constexpr std::uint32_t kBlocks = kOccupiedCell | kShortRange | kMoving;
  constexpr std::uint32_t kHides = kUnobserved | kNoData | kNoPose | kBadImage | kBadCalibration | kNoDisparity |
                                   kRecentlyBlocked | kFrozenImage | kAmbiguous | kWeakEvidence | kLidarNearer;
  for (std::uint32_t reasons = 0; reasons < 2 * kNoMotion; ++reasons) {
    const State expected = reasons & kBlocks ? State::Blocked : reasons & kHides ? State::Unknown : State::Free;
    ASSERT_EQ(stateOf(reasons), expected) << describeReasons(reasons);
  }
}

TEST(Verdict, AReasonThatNobodyKnowsIsNotFree) { EXPECT_EQ(stateOf(2 * kNoMotion), State::Unknown); }

TEST(Verdict, WhatMovesBlocksAndMakesNothingFree) {
  Verdict unknown;
  unknown.reasons = kRecentlyBlocked;
  unknown.limit(kInfinity);
  EXPECT_EQ(unknown.reasons, kRecentlyBlocked);
  unknown.limit(3.0);
  EXPECT_EQ(unknown.state, State::Blocked);
  EXPECT_EQ(unknown.free_distance_m, 0.0);
  Verdict free;
  free.reasons = 0;
  free.free_distance_m = 4.0;
  free.limit(3.0);
  EXPECT_EQ(free.state, State::Blocked);
  EXPECT_EQ(free.free_distance_m, 3.0);
}

TEST(Verdict, AFreshVerdictIsUnknown) {
  EXPECT_EQ(Verdict().state, State::Unknown);
  EXPECT_STREQ(toString(Verdict().state), "UNKNOWN");
}

/// All seen, nothing there.
BoxEvidence clearBox() {
  BoxEvidence evidence;
  evidence.unobserved.hole_along_m = evidence.unobserved.unclear_along_m = kInfinity;
  evidence.unobserved.fraction = 0.0;
  evidence.is_doubt_searched = true;
  evidence.unobserved.out_of_view = evidence.unobserved.end_out_of_view = evidence.unobserved.too_near = 0.0;
  return evidence;
}

std::uint32_t reasons(const BoxEvidence& evidence) {
  double clear_distance_m;
  return reasonsOf(evidence, CorridorConfig(), clear_distance_m);
}

/// Of so many smallest obstacles.
BoxPatch patch(double share, double begin_m) {
  const double area_m2 = share * std::pow(CorridorConfig().smallest_obstacle_m, 2);
  return {area_m2, area_m2, area_m2, begin_m};
}

TEST(Verdict, WhatIsSeenAndEmptyGivesNoReason) {
  double clear_distance_m = 0.0;
  EXPECT_EQ(reasonsOf(clearBox(), CorridorConfig(), clear_distance_m), 0u);
  EXPECT_EQ(clear_distance_m, kInfinity);
}

TEST(Verdict, WhatNobodyLookedAtIsUnobserved) { EXPECT_EQ(reasons(BoxEvidence()), kUnobserved); }

TEST(Verdict, TheNearestPatchOfTheSmallestObstacleBlocks) {
  BoxEvidence evidence = clearBox();
  evidence.patches = {patch(2.0, 3.0), patch(1.0, 2.0), patch(0.1, 1.0), {0.0, 0.0, 1.0, kInfinity}};
  double clear_distance_m = kNaN;
  EXPECT_EQ(reasonsOf(evidence, CorridorConfig(), clear_distance_m), kOccupiedCell);
  EXPECT_EQ(clear_distance_m, 2.0);
}

TEST(Verdict, ALargerPatchNeverGivesABetterState) {
  const auto rank = [](State state) { return state == State::Free ? 2 : state == State::Unknown ? 1 : 0; };
  int before = 2, states = 1;
  for (double share = 0.0; share < 1.5; share += 0.05) {
    BoxEvidence evidence = clearBox();
    evidence.patches = {patch(share, 2.0)};
    const int after = rank(stateOf(reasons(evidence)));
    EXPECT_LE(after, before) << share;
    states += after != before;
    before = after;
  }
  EXPECT_EQ(states, 3) << "chance, in doubt, there";
}

TEST(Verdict, EveryKindOfWhatIsUnobservedIsEnough) {
  const CorridorConfig config;
  for (double Unobserved::*what :
       {&Unobserved::fraction, &Unobserved::too_near, &Unobserved::out_of_view, &Unobserved::end_out_of_view}) {
    BoxEvidence evidence = clearBox();
    for (const double value : {1.0, kNaN, kInfinity}) {
      evidence.unobserved.*what = value;
      EXPECT_EQ(reasons(evidence), kUnobserved) << value;
    }
  }
  BoxEvidence evidence = clearBox();
  evidence.unobserved.hole_along_m = 3.0;
  EXPECT_EQ(reasons(evidence), kUnobserved);
  evidence.unobserved.hole_along_m = kInfinity;
  evidence.unobserved.fraction = config.max_unknown_fraction;
  evidence.unobserved.end_out_of_view = 0.3;
  evidence.unobserved.out_of_view = 0.24;  // near the camera no view is as wide as the box
  EXPECT_EQ(reasons(evidence), 0u);
  evidence.unobserved.out_of_view = 0.26;
  EXPECT_EQ(reasons(evidence), kUnobserved);
}

TEST(Verdict, WhatIsFreeBeforeAnObstacleIsBelievedOnlyOfPairsThatWouldBe) {
  const Box box{Eigen::Isometry3d::Identity(), {4.0, 1.2, 0.4}};
  BoxEvidence evidence = clearBox();
  evidence.patches = {patch(2.0, 3.0)};
  Verdict verdict;
  verdict.state = State::Blocked;
  verdict.clear_distance_m = 3.0;
  verdict.reasons = kOccupiedCell;
  EXPECT_EQ(freeDistance(verdict, evidence, CorridorConfig(), box), 3.0);
  for (const Reason reason : {kFrozenImage, kBadImage, kNoDisparity, kAmbiguous, kLidarNearer, kNoData, kNoPose}) {
    verdict.reasons = kOccupiedCell | reason;
    EXPECT_EQ(freeDistance(verdict, evidence, CorridorConfig(), box), 0.0) << describeReasons(reason);
  }
  verdict.reasons = kOccupiedCell | kUnobserved;
  evidence.unobserved.hole_along_m = 2.0;
  EXPECT_EQ(freeDistance(verdict, evidence, CorridorConfig(), box), 2.0) << "something may hide in the hole";
  evidence.patches.push_back(patch(0.3, 1.0));
  EXPECT_EQ(freeDistance(verdict, evidence, CorridorConfig(), box), 1.0) << "weak evidence before it";
}

TEST(Verdict, WhatIsFreeBeforeAnObstacleIsNoMoreThanWhatIsSeen) {
  const Box box{Eigen::Isometry3d::Identity(), {4.0, 1.2, 0.4}};
  BoxEvidence clear = clearBox();
  clear.patches = {patch(2.0, 3.5)};
  Verdict verdict;
  verdict.state = State::Blocked;
  verdict.clear_distance_m = 3.5;
  verdict.reasons = kOccupiedCell | kUnobserved;
  const auto free = [&](const BoxEvidence& evidence) { return freeDistance(verdict, evidence, CorridorConfig(), box); };
  for (double Unobserved::*what : {&Unobserved::too_near, &Unobserved::out_of_view}) {
    double before_m = 3.5;
    for (double share = 0.0; share <= 1.0; share += 0.05) {
      BoxEvidence evidence = clear;
      evidence.unobserved.*what = share;
      EXPECT_LE(free(evidence), before_m) << share;
      before_m = free(evidence);
    }
    EXPECT_EQ(before_m, 0.0);
  }
  BoxEvidence evidence = clear;
  evidence.unobserved.fraction = 1.0;
  EXPECT_EQ(free(evidence), 3.5) << "it may all be behind the obstacle";
  evidence.unobserved.unclear_along_m = 1.5;
  EXPECT_EQ(free(evidence), 1.5);
  evidence = clear;
  evidence.unobserved.end_out_of_view = 1.0;
  EXPECT_EQ(free(evidence), 3.0) << "up to the last quarter";
  evidence = clear;
  evidence.is_doubt_searched = false;
  EXPECT_EQ(free(evidence), 0.0);
}

TEST(Verdict, AReasonWithoutAPlaceLeavesNothingFree) {
  Verdict verdict;
  verdict.state = State::Free;
  verdict.free_distance_m = 4.0;
  verdict.withhold(kUnobserved);
  EXPECT_EQ(verdict.state, State::Unknown);
  EXPECT_EQ(verdict.reasons, kUnobserved);
  EXPECT_EQ(verdict.free_distance_m, 0.0);
}

TEST(Verdict, WhatFitsInTheBoxAsWellIsAmbiguousBesideWhatBlocks) {
  BoxEvidence evidence = clearBox();
  evidence.is_ambiguous = true;
  EXPECT_EQ(reasons(evidence), kAmbiguous);
  evidence.patches = {patch(1.0, 2.0)};
  EXPECT_EQ(reasons(evidence), kAmbiguous | kOccupiedCell);
}

}  // namespace
}  // namespace flight_corridor
