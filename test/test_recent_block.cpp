#include <gtest/gtest.h>

#include <vector>

#include "flight_corridor/corridor/corridor.hpp"
#include "flight_corridor/corridor/recent_block.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

using test_support::kVgaGeometry;

constexpr double kHold_s = 0.25;

/// Something upright across the beam's direction: x and y from and to, depth [m].
struct Board {
  double left_m, right_m, top_m, bottom_m, depth_m;
};

const Board kBroad{-0.4, 0.0, -0.2, 0.2, 2.95};
const Board kSmall{0.31, 0.39, -0.09, -0.01, 2.95};  // fills one cell

const Board kBeside{0.71, 1.0, -0.2, 0.2, 2.95};  // not in the box

class RecentBlockTest : public testing::Test {
 protected:
  const OccupancyMap& imageOf(const std::vector<Board>& boards) {
    cv::Mat depth_m(kVgaGeometry.size(), CV_32FC1, cv::Scalar(kNaN));
    for (const Board& board : boards) {
      const Eigen::Vector2d low = kVgaGeometry.project({board.left_m, board.top_m, board.depth_m});
      const Eigen::Vector2d high = kVgaGeometry.project({board.right_m, board.bottom_m, board.depth_m});
      const cv::Rect area(cv::Point(low.array().ceil().x(), low.array().ceil().y()), cv::Point(high.x(), high.y()));
      depth_m(area) = board.depth_m;
    }
    map_.clear();
    map_.insert(depth_m, Eigen::Isometry3d::Identity());
    return map_;
  }

  void block(const std::vector<Board>& boards, double clear_distance_m = 2.9, std::optional<double> beam_end_m = {}) {
    Verdict verdict;
    verdict.stamp_s = 10.0;
    verdict.clear_distance_m = clear_distance_m;
    block_.note(verdict, beam_end_m, imageOf(boards), box_);
  }

  bool mayRemain(double stamp_s, const std::vector<Board>& boards = {}) {
    return block_.mayRemain(stamp_s, imageOf(boards), box_);
  }

  OccupancyMap map_{MapConfig(), kVgaGeometry};
  RecentBlock block_{kHold_s, MapConfig().resolution_m};
  Box box_ = Corridor(CorridorConfig()).box(opticalFromForward());
};

TEST_F(RecentBlockTest, NothingRemainsOfWhatNeverBlocked) { EXPECT_FALSE(mayRemain(10.0, {kBroad})); }

TEST_F(RecentBlockTest, WhatIsBroadAndStoodInTheMiddleHasGoneWhenNothingIsHitThere) {
  block({kBroad});
  EXPECT_FALSE(mayRemain(10.1));
  EXPECT_FALSE(mayRemain(10.1, {kBeside}));
}

TEST_F(RecentBlockTest, WhatIsBroadMayStandAtTheBoxsEdge) {
  const Board at_edge{0.52, 0.9, -0.2, 0.2, 2.95};
  const Board farther_beside{0.9, 1.2, -0.2, 0.2, 2.95};
  block({at_edge});
  EXPECT_TRUE(mayRemain(10.1, {kBeside}));
  EXPECT_FALSE(mayRemain(10.3, {kBeside}));
  EXPECT_FALSE(mayRemain(10.1, {farther_beside}));
}

TEST_F(RecentBlockTest, WhatIsBroadIsSoBesideTheBoxToo) {
  block({{0.52, 0.9, -0.1, 0.1, 2.95}});  // a few of its cells in the box
  EXPECT_FALSE(mayRemain(10.1));
}

TEST_F(RecentBlockTest, WhatIsSmallMayRemainForTheHoldTime) {
  block({kSmall});
  EXPECT_TRUE(mayRemain(10.2));
  EXPECT_FALSE(mayRemain(10.3));
}

TEST_F(RecentBlockTest, WhatIsSmallMayRemainBesideWhatIsBroad) {
  block({kBroad, kSmall});
  EXPECT_TRUE(mayRemain(10.2));
}

TEST_F(RecentBlockTest, MistakesBehindTheOutlineOfWhatIsBroadAreNoSmallObstacles) {
  block({kBroad, {0.01, 0.12, -0.1, -0.01, 3.35}});
  EXPECT_FALSE(mayRemain(10.1));
  block({kBroad, {0.01, 0.09, -0.09, -0.01, 2.45}});
  EXPECT_TRUE(mayRemain(10.1)) << "what is before it is one";
}

TEST_F(RecentBlockTest, APostAtTheEdgeBesideWhatStandsInTheMiddleMayRemain) {
  const Board post{0.52, 0.7, -0.2, 0.2, 3.45}, moved_out{0.61, 0.79, -0.2, 0.2, 3.45};
  block({kBroad, post});
  EXPECT_TRUE(mayRemain(10.1, {moved_out}));
}

TEST_F(RecentBlockTest, WhatOnlyTheLidarMetBehindSomethingSolidMayRemain) {
  block({kBroad}, 2.9, 3.6);
  EXPECT_TRUE(mayRemain(10.1));
}

TEST_F(RecentBlockTest, WhatBeginsWhereTheBoxEndsIsNotInIt) {
  block({kBroad, {0.31, 0.39, -0.09, -0.01, 4.08}});
  EXPECT_FALSE(mayRemain(10.1));
}

TEST_F(RecentBlockTest, WhatFillsLessThanHalfOfItsCellsIsFrail) {
  block({{-0.4, 0.4, -0.03, 0.0, 2.95}});
  EXPECT_TRUE(mayRemain(10.1));
}

TEST_F(RecentBlockTest, WhatTheImageDoesNotShowMayRemain) {
  block({kBroad}, 1.5);  // the LiDAR's
  EXPECT_TRUE(mayRemain(10.2));
  block({}, 2.9);  // remembered
  EXPECT_TRUE(mayRemain(10.2));
}

TEST_F(RecentBlockTest, ForAnotherRigAllMayRemain) {
  block({kBroad});
  RecentBlock after(kHold_s, MapConfig().resolution_m);
  after.takeOver(block_);
  EXPECT_TRUE(after.mayRemain(10.2, imageOf({}), box_));
  RecentBlock last(kHold_s, MapConfig().resolution_m);
  last.takeOver(after);
  EXPECT_TRUE(last.mayRemain(10.2, imageOf({}), box_)) << "two changes of rig, one after the other";
}

}  // namespace
}  // namespace flight_corridor
