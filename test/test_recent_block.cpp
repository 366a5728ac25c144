#include <gtest/gtest.h>

#include <vector>

#include "flight_corridor/corridor/recent_block.hpp"
#include "support/corridor_box.hpp"

namespace flight_corridor {
namespace {

using test_support::kSmallest_m;

constexpr double kHold_s = 0.25;

/// @param in_middle_m2 of the area.
BoxPatch patch(double in_box_m2, double in_middle_m2, double around_m2, double begin_m = 2.9) {
  return {in_box_m2, in_middle_m2, around_m2, begin_m};
}

const BoxPatch kBroad = patch(0.16, 0.14, 0.16);
const BoxPatch kAtEdge = patch(0.03, 0.0, 0.15);
const BoxPatch kSmall = patch(0.006, 0.006, 0.006);
const BoxPatch kBeside = patch(0.0, 0.0, 0.1, kInfinity);

class RecentBlockTest : public testing::Test {
 protected:
  void block(const std::vector<BoxPatch>& patches, double clear_distance_m = 2.9) {
    Verdict verdict;
    verdict.stamp_s = 10.0;
    verdict.clear_distance_m = clear_distance_m;
    block_.onBlocked(verdict, patches, kSmallest_m);
  }

  bool mayRemain(double stamp_s, const std::vector<BoxPatch>& patches = {}) const {
    return block_.mayRemain(stamp_s, patches, kSmallest_m);
  }

  RecentBlock block_{kHold_s};
};

TEST_F(RecentBlockTest, NothingRemainsOfWhatNeverBlocked) { EXPECT_FALSE(mayRemain(10.0, {kBroad})); }

TEST_F(RecentBlockTest, WhatIsBroadAndStoodInTheMiddleHasGoneWhenItIsNotShown) {
  block({kBroad});
  EXPECT_FALSE(mayRemain(10.1));
  EXPECT_FALSE(mayRemain(10.1, {kBeside}));
}

TEST_F(RecentBlockTest, WhatIsBroadMayStandAtTheBoxsEdge) {
  block({kAtEdge});
  EXPECT_TRUE(mayRemain(10.1, {kBeside}));
  EXPECT_FALSE(mayRemain(10.3, {kBeside}));
  EXPECT_FALSE(mayRemain(10.1)) << "nothing is there";
  EXPECT_FALSE(mayRemain(10.1, {patch(0.0, 0.0, 0.4 * kSmallest_m * kSmallest_m)})) << "so small are mistakes";
}

TEST_F(RecentBlockTest, WhatIsSmallMayRemainForTheHoldTime) {
  block({kSmall});
  EXPECT_TRUE(mayRemain(10.2));
  EXPECT_FALSE(mayRemain(10.3));
}

TEST_F(RecentBlockTest, TheHoldTimeMayChangeAfterwards) {
  block({kSmall});
  block_.setHold(1.0);
  EXPECT_TRUE(mayRemain(10.9));
  block_.setHold(0.0);
  EXPECT_FALSE(mayRemain(10.1));
}

TEST_F(RecentBlockTest, WhatIsSmallMayRemainBesideWhatIsBroad) {
  block({kBroad, kSmall});
  EXPECT_TRUE(mayRemain(10.2));
  block_ = RecentBlock(kHold_s);
  block({kSmall, kBroad});
  EXPECT_TRUE(mayRemain(10.2)) << "in whatever order";
}

TEST_F(RecentBlockTest, WhatDoesNotBlockDoesNotRemain) {
  block({kBroad, kBeside, patch(0.4 * kSmallest_m * kSmallest_m, 0.0, 0.01)});
  EXPECT_FALSE(mayRemain(10.1));
}

TEST_F(RecentBlockTest, APostAtTheEdgeBesideWhatStandsInTheMiddleMayRemain) {
  block({kBroad, kAtEdge});
  EXPECT_TRUE(mayRemain(10.1, {kBeside}));
}

TEST_F(RecentBlockTest, WhatTheImageDoesNotShowMayRemain) {
  block({kBroad}, 1.5);  // the LiDAR's
  EXPECT_TRUE(mayRemain(10.2));
  block_ = RecentBlock(kHold_s);
  block({}, 2.9);  // remembered
  EXPECT_TRUE(mayRemain(10.2));
}

TEST_F(RecentBlockTest, ForAnotherRigAllMayRemain) {
  block({kBroad});
  RecentBlock after(kHold_s);
  after.takeOver(block_);
  EXPECT_TRUE(after.mayRemain(10.2, {}, kSmallest_m));
  RecentBlock last(kHold_s);
  last.takeOver(after);
  EXPECT_TRUE(last.mayRemain(10.2, {}, kSmallest_m)) << "two changes of rig, one after the other";
}

}  // namespace
}  // namespace flight_corridor
