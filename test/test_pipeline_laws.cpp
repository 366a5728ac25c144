#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "sim/rig.hpp"
#include "sim/still.hpp"
#include "support/masonry.hpp"

// Laws that hold of every scene, on rendered stereo pairs.

namespace flight_corridor {
namespace {

using World = std::vector<sim::Primitive>;
using test_support::cubeAt;
using test_support::masonryAt;

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

}  // namespace
}  // namespace flight_corridor
