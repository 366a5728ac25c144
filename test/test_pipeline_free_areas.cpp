#include <gtest/gtest.h>

#include <cmath>

#include "flight_corridor/pipeline.hpp"
#include "sim/simulation.hpp"

namespace flight_corridor {
namespace {

/// A pipeline that has seen a simulated flight up to a pair.
class AfterAFlight {
 public:
  AfterAFlight(const std::string& scene, std::size_t pair) : simulation_(options(scene)) {
    for (std::size_t i = 0; i <= pair; ++i) last = pipeline.process(simulation_.frame(i)).verdict;
  }

 private:
  static sim::SimulationOptions options(const std::string& scene) {
    sim::SimulationOptions options;
    options.scene = scene;
    options.seed = 1;
    options.rate_hz = 1.0;
    options.image_scale = 0.5;
    return options;
  }
  static Config config() {
    Config config;
    config.corridor.smallest_obstacle_m = 0.08;
    return config;
  }

  sim::Simulation simulation_;

 public:
  Pipeline pipeline{config(), StereoGeometry(simulation_.calibration()), Rig()};
  Verdict last;
};

TEST(PipelineFreeAreas, AgreeWithAQueryOfEachDirectionsBox) {
  int same = 0, all = 0, free = 0, blocked = 0;
  for (const char* scene : {"forest", "side_obstacles", "narrow_gap", "checker_wall", "low_ground"}) {
    for (const std::size_t pair : {1u, 4u}) {
      AfterAFlight flight(scene, pair);
      const AreaGrid areas = flight.pipeline.freeAreas();
      ASSERT_EQ(areas.areas.size(), 65u);
      for (const FreeArea& area : areas.areas) {
        Box box = flight.pipeline.boxInCamera();
        box.T_M_F.rotate(Eigen::AngleAxisd(area.yaw_rad, Eigen::Vector3d::UnitZ()) *
                         Eigen::AngleAxisd(-area.pitch_rad, Eigen::Vector3d::UnitY()));
        const Verdict asked = flight.pipeline.query(box);
        ++all;
        same += asked.state == area.verdict.state;
        free += asked.state == State::Free;
        blocked += asked.state == State::Blocked;
        EXPECT_FALSE(area.verdict.state == State::Free && asked.state == State::Blocked) << scene << ' ' << pair;
      }
    }
  }
  EXPECT_GE(same, 0.99 * all);
  EXPECT_GT(free, all / 10);
  EXPECT_GT(blocked, all / 10);
}

TEST(PipelineFreeAreas, StraightAheadIsTheCorridor) {
  AfterAFlight flight("forest", 3);
  const Verdict corridor = flight.last;
  const AreaGrid areas = flight.pipeline.freeAreas();
  EXPECT_EQ(areas.areas[32].yaw_rad, 0.0);
  EXPECT_EQ(areas.areas[32].verdict.state, corridor.state);
  EXPECT_EQ(flight.pipeline.query(flight.pipeline.box()).state, corridor.state);
}

TEST(PipelineFreeAreas, ABoxThatBeginsAtTheUavButIsNoWayIsNotExcusedForBeingOutOfView) {
  AfterAFlight flight("wide_gap", 1);
  ASSERT_EQ(flight.last.state, State::Free);
  const Box corridor = flight.pipeline.box();
  EXPECT_EQ(flight.pipeline.query(corridor).state, State::Free);
  for (const double yaw_rad : {1.0, -1.0, M_PI}) {
    Box turned = corridor;
    turned.T_M_F.translate(Eigen::Vector3d(0.5, 0.0, 0.0));
    turned.T_M_F.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
    EXPECT_EQ(flight.pipeline.query(turned).state, State::Unknown) << yaw_rad;
  }
  Box wide = corridor;
  wide.size_m.y() = 6.0;
  EXPECT_NE(flight.pipeline.query(wide).state, State::Free);
}

TEST(PipelineFreeAreas, NothingIsFreeBeforeThereIsAPair) {
  AfterAFlight flight("forest", 0);
  Pipeline fresh(flight.pipeline.config(), flight.pipeline.geometry(), Rig());
  const AreaGrid areas = fresh.freeAreas();
  EXPECT_EQ(areas.best, -1);
  for (const FreeArea& area : areas.areas) {
    EXPECT_EQ(area.verdict.state, State::Unknown);
    EXPECT_EQ(area.verdict.reasons, kNoData);
    EXPECT_EQ(area.verdict.free_distance_m, 0.0);
  }
  for (const double range_m : fresh.levelScan(opticalFromForward().linear()).range_m) EXPECT_TRUE(std::isnan(range_m));
}

TEST(PipelineFreeAreas, FreeIsUpToTheEndBlockedUpToWhatBlocks) {
  AfterAFlight flight("side_obstacles", 2);
  int free = 0, blocked = 0;
  for (const FreeArea& area : flight.pipeline.freeAreas().areas) {
    const Verdict& verdict = area.verdict;
    switch (verdict.state) {
      case State::Free:
        EXPECT_DOUBLE_EQ(verdict.free_distance_m, flight.pipeline.config().corridor.length_m);
        ++free;
        break;
      case State::Blocked:
        EXPECT_LE(verdict.free_distance_m, verdict.clear_distance_m);
        ++blocked;
        break;
      case State::Unknown:
        EXPECT_LE(verdict.free_distance_m, flight.pipeline.config().corridor.length_m);
        EXPECT_TRUE(verdict.free_distance_m == 0.0 || !(verdict.reasons & kAmbiguous)) << "nobody knows where";
        break;
    }
  }
  EXPECT_GT(free, 0);
  EXPECT_GT(blocked, 0);
}

TEST(PipelineFreeAreas, TheScanShowsAWallAllAlong) {
  AfterAFlight flight("wall", 6);
  const LevelScan scan = flight.pipeline.levelScan(opticalFromForward().linear());
  ASSERT_EQ(scan.range_m.size() % 2, 1u);
  EXPECT_DOUBLE_EQ(scan.first_yaw_rad, -scan.step_rad * (scan.range_m.size() / 2));
  const double clear_m = flight.pipeline.query(flight.pipeline.box()).clear_distance_m;
  ASSERT_LT(clear_m, 4.0);
  for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
    const double yaw_rad = scan.first_yaw_rad + static_cast<double>(i) * scan.step_rad;
    if (clear_m / std::cos(yaw_rad) > 3.7) continue;  // it may stand behind the end
    if (i + 1 == scan.range_m.size()) {
      EXPECT_TRUE(std::isnan(scan.range_m[i])) << "more than a quarter of it is out of the right camera's view";
      continue;
    }
    EXPECT_NEAR(scan.range_m[i], clear_m / std::cos(yaw_rad), 0.5) << yaw_rad;
  }
}

}  // namespace
}  // namespace flight_corridor
