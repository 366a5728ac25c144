#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "sim/rig.hpp"
#include "sim/still.hpp"
#include "support/calibrations.hpp"
#include "support/masonry.hpp"
#include "support/pipeline_inputs.hpp"
#include "support/wall_scene.hpp"

// Laws that hold of every scene, on stereo pairs.

namespace flight_corridor {
namespace {

using World = std::vector<sim::Primitive>;
using test_support::cubeAt;
using test_support::kSmallGeometry;
using test_support::kVgaGeometry;
using test_support::masonryAt;
using test_support::reading;
using test_support::rigWithLidar;
using test_support::wallFrame;

/// A scene before a textured wall.
struct Place {
  std::string name;
  State state;  // of the default corridor
  World world;
};

World wall(double x_m) { return {masonryAt(x_m)}; }

World with(World world, const sim::Primitive& obstacle) {
  world.push_back(obstacle);
  return world;
}

std::vector<Place> places() {
  return {{"a wall behind the end", State::Free, wall(6.0)},
          {"a wall in the box", State::Blocked, wall(3.0)},
          {"a box at the side", State::Free, with(wall(6.0), cubeAt({3.0, 0.95, sim::kHeight_m}, 0.4))},
          {"a bare wall", State::Unknown, {sim::backdrop(6.0, sim::plain(0.5))}}};
}

StereoGeometry geometry() { return StereoGeometry(sim::defaultRig().calibration); }

State stateIn(const World& world, const CorridorConfig& corridor = {}) {
  Config config;
  config.corridor = corridor;
  Pipeline pipeline(config, geometry(), Rig());
  return pipeline.process(sim::stillPair(world, 1)).verdict.state;
}

TEST(PipelineLaws, AWiderBoxIsNotFreeWhereANarrowerOneIsNot) {
  for (const Place& place : places()) {
    const StereoFrame pair = sim::stillPair(place.world, 1);
    bool was_free = true;
    for (const double width_m : {0.4, 0.8, 1.2, 1.6, 2.0, 2.4}) {
      Config config;
      config.corridor.width_m = width_m;
      Pipeline pipeline(config, geometry(), Rig());
      const bool is_free = pipeline.process(pair).verdict.state == State::Free;
      EXPECT_FALSE(is_free && !was_free) << place.name << ", " << width_m << " m";
      was_free = is_free;
    }
  }
}

TEST(PipelineLaws, NothingThatIsAddedWithinTheBoxLeavesItFree) {
  for (const Place& place : places()) {
    EXPECT_EQ(stateIn(place.world), place.state) << place.name;
    for (const double x_m : {1.5, 2.5}) {
      for (const double y_m : {-0.4, 0.1}) {
        const sim::Primitive obstacle = cubeAt({x_m, y_m, sim::kHeight_m}, 0.3);
        EXPECT_NE(stateIn(with(place.world, obstacle)), State::Free) << place.name << ", " << x_m << " m, " << y_m;
      }
    }
  }
}

TEST(PipelineLaws, WhatIsAddedBesideABlockedBoxDoesNotFreeIt) {
  for (const double y_m : {-1.0, 1.0}) {
    EXPECT_EQ(stateIn(with(wall(3.0), cubeAt({2.0, y_m, sim::kHeight_m}, 0.4))), State::Blocked) << y_m;
  }
}

/// From where on all of the box is in view: the corridor's verdict excuses what the cameras cannot see, a query
/// nothing.
TEST(PipelineLaws, AQueryOfTheCorridorsBoxAgreesWithTheVerdict) {
  Config config;
  config.corridor.offset_m.x() = 1.5;
  config.corridor.length_m = 2.5;
  for (const Place& place : places()) {
    Pipeline pipeline(config, geometry(), Rig());
    const Verdict verdict = pipeline.process(sim::stillPair(place.world, 1)).verdict;
    EXPECT_EQ(verdict.state, place.state) << place.name;
    const Verdict query = pipeline.query(pipeline.box());
    EXPECT_EQ(query.state, verdict.state) << place.name << ": " << describeReasons(query.reasons);
  }
}

/// All distances up to which a pair shows space free: of the corridor, of each free area, of each direction of the
/// scan; 0: not known.
std::vector<double> freeDistances(const StereoFrame& pair, const StereoGeometry& of, double corridor_yaw_rad = 0.0) {
  Pipeline pipeline(Config(), of, Rig());
  pipeline.pointAlong(opticalFromForward() *
                      Eigen::Isometry3d(Eigen::AngleAxisd(corridor_yaw_rad, Eigen::Vector3d::UnitZ())));
  std::vector<double> free_m{pipeline.process(pair).verdict.free_distance_m};
  for (const FreeArea& area : pipeline.freeAreas().areas) free_m.push_back(area.verdict.free_distance_m);
  for (const double range_m : pipeline.levelScan(opticalFromForward().linear()).range_m) {
    free_m.push_back(std::isnan(range_m) ? 0.0 : std::min(range_m, Config().corridor.length_m));
  }
  return free_m;
}

constexpr double kNoise_m = 0.05;  // matches and their planes differ a little from pair to pair
constexpr double kStep = 0.12;     // of a depth: holes are looked for in such steps

/// As much again, or one step of depth more; nothing is more than nothing known.
double most(double before_m) { return before_m > 0.0 ? (1.0 + kStep) * before_m + kNoise_m : kInfinity; }

TEST(PipelineLaws, AnObstacleBehindAnotherMakesNothingMoreFree) {
  for (const double yaw_rad : {0.0, 0.5, -0.5}) {
    const World near = with(wall(6.0), cubeAt({2.0, 0.0, sim::kHeight_m}, 0.5));
    const std::vector<double> before = freeDistances(sim::stillPair(near, 1), geometry(), yaw_rad);
    for (const World& more : {with(near, cubeAt({3.4, 0.3, sim::kHeight_m}, 0.5)), with(near, masonryAt(3.5))}) {
      const std::vector<double> after = freeDistances(sim::stillPair(more, 1), geometry(), yaw_rad);
      for (std::size_t i = 0; i < before.size(); ++i) {
        EXPECT_LE(after[i], most(before[i])) << i << ", " << yaw_rad;
      }
    }
  }
}

/// Of what is not FREE because of what is out of view no more than its part before the last quarter is known to be free
/// up to an obstacle, and only if most of it is in view.
TEST(PipelineLaws, AnObstacleInViewSaysNothingOfWhatIsOutOfView) {
  for (const double yaw_rad : {0.6, -0.6, 0.9, -0.9}) {
    const std::vector<double> empty = freeDistances(wallFrame(kSmallGeometry, 3, 1.0), kSmallGeometry, yaw_rad);
    const std::vector<double> blocked = freeDistances(wallFrame(kSmallGeometry, 6, 1.0), kSmallGeometry, yaw_rad);
    int unknown = 0;
    for (std::size_t i = 0; i < empty.size(); ++i) {
      if (empty[i] > 0.0) continue;
      EXPECT_LE(blocked[i], 0.75 * Config().corridor.length_m) << i << ", " << yaw_rad;
      ++unknown;
    }
    EXPECT_GT(unknown, 0) << yaw_rad;
    EXPECT_TRUE(std::abs(yaw_rad) < 0.8 || blocked.front() == 0.0) << yaw_rad;
  }
}

TEST(PipelineLaws, EvidenceTakenAwayMakesNothingMoreFree) {
  for (const double wall_m : {6.0, 3.0}) {
    const StereoFrame pair = sim::stillPair(with(wall(wall_m), cubeAt({2.6, 0.2, sim::kHeight_m}, 0.4)), 1);
    const std::vector<double> before = freeDistances(pair, geometry());
    const cv::Size size = pair.left.size();
    for (const cv::Rect& part :
         {cv::Rect(0, 0, size.width, 200), cv::Rect(0, 230, size.width, 20), cv::Rect(0, 260, size.width, 60),
          cv::Rect(0, 0, 250, size.height), cv::Rect(350, 0, size.width - 350, size.height)}) {
      StereoFrame less{pair.stamp_s, pair.left.clone(), pair.right.clone()};
      for (const cv::Mat& image : {less.left, less.right}) image(part).setTo(128);
      const std::vector<double> after = freeDistances(less, geometry());
      for (std::size_t i = 0; i < before.size(); ++i) {
        EXPECT_LE(after[i], most(before[i])) << i << ", " << part << ", wall at " << wall_m;
      }
    }
  }
}

/// Whatever stands there: the wall's own edge around it is matched on the wall.
TEST(PipelineLaws, WhatIsClippedIsNotFree) {
  const StereoFrame pair = sim::stillPair(wall(6.0), 1);
  ASSERT_EQ(Pipeline(Config(), geometry(), Rig()).process(pair).verdict.state, State::Free);
  const int shift_px = static_cast<int>(std::lround(geometry().disparity(6.0)));
  for (const cv::Rect& part : {cv::Rect(300, 220, 50, 50), cv::Rect(280, 200, 90, 70)}) {
    for (const int level : {0, 255}) {
      StereoFrame clipped{pair.stamp_s, pair.left.clone(), pair.right.clone()};
      clipped.left(part).setTo(level);
      clipped.right(part - cv::Point(shift_px, 0)).setTo(level);
      Pipeline pipeline(Config(), geometry(), Rig());
      EXPECT_NE(pipeline.process(clipped).verdict.state, State::Free) << part << ", " << level;
    }
  }
}

/// A bar without texture, upright or level, whose ends are in view or not.
TEST(PipelineLaws, ABarThatIsTurnedIsNotFree) {
  for (const double width_m : {0.06, 0.12}) {
    for (const double length_m : {0.6, 1.5, 8.0}) {
      const Eigen::Vector3d middle_W(2.0, 0.1, sim::kHeight_m);
      for (const Eigen::Vector3d& size_m :
           {Eigen::Vector3d(width_m, width_m, length_m), Eigen::Vector3d(width_m, length_m, width_m)}) {
        EXPECT_NE(stateIn(with(wall(6.0), sim::makeBox(middle_W, size_m, sim::plain(0.2)))), State::Free)
            << size_m.transpose();
      }
    }
  }
}

TEST(PipelineLaws, AfterItsMapWasClearedNoDirectionIsFree) {
  Pipeline pipeline(Config(), kSmallGeometry, Rig());
  pipeline.process(wallFrame(kSmallGeometry, 7, 1.0));
  ASSERT_GT(pipeline.query(pipeline.box()).free_distance_m, 0.0);
  pipeline.clear({Eigen::Vector3d(-1.0, -1.0, 0.0), Eigen::Vector3d(1.0, 1.0, 4.0)});
  EXPECT_EQ(pipeline.query(pipeline.box()).free_distance_m, 0.0);
  for (const FreeArea& area : pipeline.freeAreas().areas) EXPECT_EQ(area.verdict.free_distance_m, 0.0);
}

TEST(PipelineLaws, NoBoxMostlyOutOfViewIsFreeUpToAnObstacle) {
  Pipeline pipeline(Config(), kSmallGeometry, Rig());
  pipeline.process(wallFrame(kSmallGeometry, 7, 1.0));
  Box box = test_support::ahead(1.0, 2.5);
  box.size_m.y() = 12.0;
  const Verdict verdict = pipeline.query(box);
  EXPECT_EQ(verdict.state, State::Blocked);
  EXPECT_EQ(verdict.free_distance_m, 0.0);
}

/// A wall at 7 m, stripes on it that fit at 1.9 m as well, and a part without texture.
StereoFrame stripesBesideABarePart(double stamp_s) {
  StereoFrame pair = wallFrame(kSmallGeometry, 3, stamp_s);
  const int shift_px = 3 + static_cast<int>(kSmallGeometry.principalPointDifference());
  for (int v = 95; v < 145; ++v) {
    for (int u = 160; u < 205; ++u) {
      pair.left.at<std::uint8_t>(v, u) = pair.right.at<std::uint8_t>(v, u - shift_px) = u / 4 % 2 == 0 ? 60 : 190;
    }
  }
  for (const cv::Mat& image : {pair.left, pair.right}) image.colRange(60, 140).setTo(128);
  return pair;
}

/// In a direction with a hole doubt is not searched.
TEST(PipelineLaws, BeforeARememberedObstacleADirectionIsNoMoreFreeThanItsBox) {
  Config config;
  config.map.frame_id = "odom";
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  Pipeline pipeline(config, kSmallGeometry, Rig());
  pipeline.process(wallFrame(kSmallGeometry, 7, 1.0), here);
  pipeline.process(stripesBesideABarePart(1.1), here);
  const Verdict query = pipeline.query(pipeline.box());
  ASSERT_EQ(query.state, State::Blocked);
  ASSERT_TRUE(query.reasons & kAmbiguous) << describeReasons(query.reasons);
  const AreaGrid& areas = pipeline.freeAreas();
  const Verdict& ahead = areas.areas[areas.areas.size() / 2].verdict;
  EXPECT_EQ(ahead.state, State::Blocked);
  EXPECT_EQ(ahead.free_distance_m, query.free_distance_m);
}

/// Two equal posts, the left one matched with the right one behind the box, before a wall.
struct EqualPosts {
  int wall_px, near_px, matched_px, width_px;  // disparities, and how wide they are

  StereoFrame pair(double stamp_s) const {
    StereoFrame pair = wallFrame(kVgaGeometry, wall_px, stamp_s);
    cv::Mat post(kVgaGeometry.size().height, width_px, CV_8UC1);
    cv::RNG(5).fill(post, cv::RNG::UNIFORM, 0, 256);
    for (const int u : {300, 300 + near_px - matched_px}) {
      const int u_right = u - near_px - static_cast<int>(kVgaGeometry.principalPointDifference());
      post.copyTo(pair.left.colRange(u, u + width_px));
      post.copyTo(pair.right.colRange(u_right, u_right + width_px));
    }
    return pair;
  }
};

/// Its word on a surface holds for what is matched there.
TEST(PipelineLaws, ALidarThatMeetsTheWallBehindFreesNoPostsThatFitOnEachOther) {
  const EqualPosts posts{5, 23, 9, 6};
  Pipeline alone(Config(), kVgaGeometry, Rig()), pipeline(Config(), kVgaGeometry, rigWithLidar());
  ASSERT_TRUE(alone.process(posts.pair(1.0)).verdict.reasons & kAmbiguous);
  for (const double stamp_s : {0.98, 0.99, 1.0}) pipeline.addRange(reading(stamp_s, kVgaGeometry.depth(posts.wall_px)));
  const Report& report = pipeline.process(posts.pair(1.0));
  ASSERT_TRUE(report.lidar_range_valid);
  EXPECT_NE(report.verdict.state, State::Free);
}

TEST(PipelineLaws, ACorridorThatIsMovedWithTheWorldIsAsLong) {
  for (const double moved_m : {-0.3, 0.5}) {
    Config config;
    Pipeline here(config, geometry(), Rig());
    config.corridor.offset_m.x() = moved_m;
    Pipeline moved(config, geometry(), Rig());
    const Verdict before = here.process(sim::stillPair(wall(3.0), 1)).verdict;
    const Verdict after = moved.process(sim::stillPair(wall(3.0 + moved_m), 1)).verdict;
    EXPECT_NEAR(after.clear_distance_m, before.clear_distance_m, kNoise_m);
    EXPECT_NEAR(after.free_distance_m, before.free_distance_m, kStep * 3.5);
  }
}

/// The scan's ranges are from its frame's origin on, the camera; of the corridor it has the height.
TEST(PipelineLaws, NoOffsetOfTheCorridorMovesTheScan) {
  const Eigen::Matrix3d R_C_H = opticalFromForward().linear();
  const World low = with(wall(6.0), cubeAt({2.2, 0.0, sim::kHeight_m - 0.7}, 0.4));
  const auto scanOf = [&](const World& world, const Eigen::Vector3d& offset_m) {
    Config config;
    config.corridor.offset_m = offset_m;
    Pipeline pipeline(config, geometry(), Rig());
    pipeline.process(sim::stillPair(world, 1));
    return pipeline.levelScan(R_C_H).range_m;
  };
  const std::vector<double> before = scanOf(wall(3.0), Eigen::Vector3d::Zero());
  const std::size_t ahead = before.size() / 2;
  EXPECT_NEAR(before[ahead], 3.0, kStep * 3.0);
  for (const Eigen::Vector3d& offset_m : {Eigen::Vector3d(-0.3, 0.0, 0.0), Eigen::Vector3d(0.5, 0.2, 0.0)}) {
    const std::vector<double> after = scanOf(wall(3.0), offset_m);
    for (std::size_t i = ahead - 4; i <= ahead + 4; ++i) EXPECT_NEAR(after[i], before[i], kNoise_m) << i;
  }
  EXPECT_EQ(scanOf(low, Eigen::Vector3d::Zero())[ahead], kInfinity);
  EXPECT_NEAR(scanOf(low, {0.0, 0.0, -0.7})[ahead], 2.0, kStep * 2.0);
}

}  // namespace
}  // namespace flight_corridor
