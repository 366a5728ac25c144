#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "flight_corridor/corridor/corridor.hpp"
#include "flight_corridor/corridor/movers.hpp"
#include "flight_corridor/pipeline.hpp"
#include "sim/rig.hpp"
#include "sim/simulation.hpp"
#include "support/camera_pose.hpp"

namespace flight_corridor {
namespace {

using test_support::poseAt;

constexpr double kWall_m = 8.0, kBoard_m = 3.0;
constexpr int kStep_px = 12;  // 1 m/s at 10 Hz, at the board's depth

/// A hovering or flying camera before a textured wall, and a textured board of 0.5 m x 1 m before it.
class MoversTest : public testing::Test {
 protected:
  /// The next pair, 0.1 s later.
  /// @param board_px the board's first column; absent: no board.  @param ahead_m of the camera.
  void see(std::optional<int> board_px, double ahead_m = 0.0) {
    stamp_s_ += 0.1;
    cv::Mat depth_m(geometry_.size(), CV_32FC1, cv::Scalar(kWall_m - ahead_m));
    if (board_px) {
      const cv::Rect board(*board_px, 180, 58, 117);
      depth_m(board & cv::Rect({0, 0}, depth_m.size())).setTo(kBoard_m - ahead_m);
    }
    const cv::Mat textured(geometry_.size(), CV_8UC1, cv::Scalar(255));
    const CameraPose pose = poseAt(ahead_m);
    earlier_.moveTo(stamp_s_, pose, 1.5);
    movers_.look(stamp_s_, pose, depth_m, textured, earlier_);
    cv::Mat met_left_px = geometry_.disparity(1.0) / depth_m, met_right_px = met_left_px.clone();
    earlier_.add(stamp_s_, pose, depth_m, textured, met_left_px, met_right_px);
  }

  double freeAhead(double mover_mps = 1.6) const {
    SpeedConfig speed;
    speed.mover_mps = mover_mps;
    return movers_.freeUpTo(corridorBox(CorridorConfig(), opticalFromForward()), speed);
  }

  void walkAcross(int pairs) {
    for (int i = 0; i < pairs; ++i) see(100 + i * kStep_px);
  }

  StereoGeometry geometry_{sim::defaultRig().calibration};
  EarlierPairs earlier_{geometry_};
  Movers movers_{geometry_};
  double stamp_s_ = 1.0;
};

TEST_F(MoversTest, WhatWalksAcrossBlocksBeforeItIsThere) {
  walkAcross(10);
  const double free_m = freeAhead();
  EXPECT_GT(free_m, 0.0);
  EXPECT_LT(free_m, 3.0);
}

TEST_F(MoversTest, TheFasterOthersMayMoveTheLessIsFree) {
  walkAcross(10);
  EXPECT_GT(freeAhead(0.0), freeAhead(1.0));
  EXPECT_GT(freeAhead(1.0), freeAhead(1.4));
  EXPECT_GT(freeAhead(1.4), freeAhead(2.0));
}

TEST_F(MoversTest, WhatStandsStillDoesNotMove) {
  for (int i = 0; i < 12; ++i) see(200);
  EXPECT_EQ(freeAhead(10.0), kInfinity);
}

TEST_F(MoversTest, WhatAppearsAndStandsStillDoesNotMove) {
  for (int i = 0; i < 12; ++i) see(i < 4 ? std::nullopt : std::optional<int>(200));
  EXPECT_EQ(freeAhead(10.0), kInfinity);
}

TEST_F(MoversTest, WhatTheCameraFliesPastDoesNotMove) {
  const double away_px = -120.0 * kBoard_m;  // of the board's left side, times its depth
  for (int i = 0; i < 12; ++i) {
    const double ahead_m = 0.1 * i;
    see(static_cast<int>(std::lround(geometry_.calibration().cx_px + away_px / (kBoard_m - ahead_m))), ahead_m);
  }
  EXPECT_EQ(freeAhead(10.0), kInfinity);
}

TEST_F(MoversTest, WhatStoppedIsForgottenSoon) {
  walkAcross(10);
  ASSERT_LT(freeAhead(), 4.0);
  for (int i = 0; i < 18; ++i) see(100 + 9 * kStep_px);
  EXPECT_EQ(freeAhead(), kInfinity);
}

TEST_F(MoversTest, WhatLeftTheViewMayComeBackForTwoSeconds) {
  for (int i = 0; i < 14; ++i) see(100 - i * kStep_px);  // out at the left
  const double at_once_m = freeAhead();
  ASSERT_LT(at_once_m, 4.0);
  for (int i = 0; i < 10; ++i) see(std::nullopt);
  EXPECT_LT(freeAhead(), at_once_m);
  for (int i = 0; i < 15; ++i) see(std::nullopt);
  EXPECT_EQ(freeAhead(), kInfinity);
}

TEST_F(MoversTest, WhileTheMotionIsUnknownNothingIsFreeBesideAMover) {
  walkAcross(10);
  ASSERT_GT(freeAhead(), 0.0);
  movers_.look(stamp_s_ + 0.1, std::nullopt, cv::Mat(), cv::Mat(), earlier_);
  EXPECT_EQ(freeAhead(), 0.0);
  movers_.look(stamp_s_ + 2.1, std::nullopt, cv::Mat(), cv::Mat(), earlier_);
  EXPECT_EQ(freeAhead(), kInfinity);
}

TEST_F(MoversTest, PosesOfAnotherSeriesKnowNoMovers) {
  walkAcross(10);
  ASSERT_LT(freeAhead(), 4.0);
  const cv::Mat depth_m(geometry_.size(), CV_32FC1, cv::Scalar(kWall_m)),
      textured(geometry_.size(), CV_8UC1, cv::Scalar(255));
  earlier_.forget();
  movers_.look(stamp_s_ + 0.1, poseAt(0.0, 2), depth_m, textured, earlier_);
  EXPECT_EQ(freeAhead(), kInfinity);
}

TEST_F(MoversTest, BehindAnObstacleItIsNotForgotten) {
  walkAcross(10);
  ASSERT_LT(freeAhead(), 4.0);
  const cv::Mat near_m(geometry_.size(), CV_32FC1, cv::Scalar(1.5)), textured(geometry_.size(), CV_8UC1, cv::Scalar(0));
  for (int i = 1; i <= 15; ++i) movers_.look(stamp_s_ + 0.1 * i, poseAt(0.0), near_m, textured, earlier_);
  EXPECT_LT(freeAhead(), 4.0);
}

/// A flight of which the pipeline is told the poses.
class Flight {
 public:
  explicit Flight(const std::string& scene) : simulation_(options(scene)) {}

  Pipeline pipeline(double mover_mps) const {
    Config config;
    config.speed.mover_mps = mover_mps;
    config.corridor.smallest_obstacle_m = 0.08;
    return Pipeline(config, StereoGeometry(simulation_.calibration()), Rig());
  }
  std::size_t size() const { return simulation_.frameTimes().size(); }
  StereoFrame frame(std::size_t i) const { return simulation_.frame(i); }
  Eigen::Isometry3d pose(double stamp_s) const { return simulation_.T_W_B(stamp_s) * simulation_.T_B_C(); }
  /// Whether the corridor is truly blocked.
  bool isBlocked(std::size_t i) const { return std::isfinite(simulation_.truth(i).clear_exact_m); }

 private:
  static sim::SimulationOptions options(const std::string& scene) {
    sim::SimulationOptions options;
    options.scene = scene;
    options.seed = 9101;
    options.rate_hz = 10.0;
    options.image_scale = 0.5;
    return options;
  }

  sim::Simulation simulation_;
};

TEST(PipelineMovers, WhoWalksInBlocksBeforeTheyAreThere) {
  const Flight flight("intruder");
  Pipeline pipeline = flight.pipeline(1.6), without = flight.pipeline(0.0);
  std::size_t first_moving = flight.size(), i = 0;
  for (; i < flight.size() && !flight.isBlocked(i); ++i) {
    const StereoFrame frame = flight.frame(i);
    const Verdict verdict = pipeline.process(frame, flight.pose(frame.stamp_s)).verdict;
    if (verdict.reasons & kMoving) {
      EXPECT_EQ(verdict.state, State::Blocked);
      EXPECT_LT(verdict.free_distance_m, CorridorConfig().length_m);
      first_moving = std::min(first_moving, i);
    }
    EXPECT_FALSE(without.process(frame, flight.pose(frame.stamp_s)).verdict.reasons & kMoving);
  }
  ASSERT_LT(i, flight.size());
  const AreaGrid& areas = pipeline.freeAreas();
  EXPECT_TRUE(areas.areas[areas.areas.size() / 2].verdict.reasons & kMoving) << "straight ahead";
  EXPECT_EQ(pipeline.query(pipeline.box()).state, State::Blocked);
  const LevelScan scan = pipeline.levelScan(opticalFromForward().linear());
  EXPECT_EQ(scan.range_m[scan.range_m.size() / 2], kInfinity) << "there is nothing ahead yet";
  EXPECT_LE(first_moving + 5, i) << "BLOCKED half a second before they are in the box";
}

TEST(PipelineMovers, InAStaticWorldTheRuleChangesNothing) {
  for (const char* scene : {"forest", "foliage", "fence"}) {
    const Flight flight(scene);
    Pipeline pipeline = flight.pipeline(1.6), without = flight.pipeline(0.0);
    for (std::size_t i = 0; i < 15; ++i) {
      const StereoFrame frame = flight.frame(i);
      const Verdict one = pipeline.process(frame, flight.pose(frame.stamp_s)).verdict;
      const Verdict other = without.process(frame, flight.pose(frame.stamp_s)).verdict;
      EXPECT_EQ(one.reasons, other.reasons) << scene << ' ' << i;
      EXPECT_EQ(one.free_distance_m, other.free_distance_m) << scene << ' ' << i;
      const AreaGrid areas = pipeline.freeAreas(), areas_without = without.freeAreas();
      for (std::size_t direction = 0; direction < areas.areas.size(); ++direction) {
        EXPECT_EQ(areas.areas[direction].verdict.reasons, areas_without.areas[direction].verdict.reasons);
      }
    }
  }
}

}  // namespace
}  // namespace flight_corridor
