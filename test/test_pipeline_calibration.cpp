#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "sim/simulation.hpp"
#include "support/wrong_lens.hpp"

// Images that are not what the calibration says, without a LiDAR: nothing else contradicts depth that is wrong.

namespace flight_corridor {
namespace {

using namespace test_support;

/// A plate beside a corridor of 1 m that reaches 6 cm into it, before a wall.
std::vector<sim::Primitive> plateAtTheSide(double ahead_m, double side, std::uint64_t seed) {
  sim::Random random(seed, sim::Stream::Scene);
  return {sim::backdrop(5.0, sim::masonry(random)),
          sim::makeBox({3.0, 0.0, -0.1}, {12.0, 8.0, 0.2}, sim::textured(random, 0.4, 0.3, 0.3)),
          sim::makeBox({ahead_m, side * (0.5 - 0.06 + 0.15), sim::kHeight_m}, {0.02, 0.3, 0.6},
                       sim::textured(random, 0.5, 0.35, 0.1))};
}

TEST(PipelineCalibration, APlateAtTheSideIsNotFreeThroughAWrongLensModel) {
  Config config;
  config.corridor.width_m = 1.0;
  const StereoGeometry geometry(sim::defaultRig().calibration);
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const std::vector<sim::Primitive> world = plateAtTheSide(1.0 + 0.2 * seed, seed % 2 == 0 ? 1.0 : -1.0, seed);
    Pipeline pipeline(config, geometry, Rig()), right(config, geometry, Rig());
    const Report& report = pipeline.process(throughFisheyes(world, seed, false));
    EXPECT_NE(report.verdict.state, State::Free) << seed;
    EXPECT_TRUE(report.verdict.reasons & kBadCalibration) << seed << " " << report.rows.offset_px;
    EXPECT_FALSE(report.clears);
    const Verdict& verdict = right.process(throughFisheyes(world, seed, true)).verdict;
    EXPECT_EQ(verdict.state, State::Blocked) << seed << " " << describeReasons(verdict.reasons);
    EXPECT_FALSE(verdict.reasons & kBadCalibration) << seed;
  }
}

TEST(PipelineCalibration, RightImagesThatAreLateOrLowAreNeverFree) {
  sim::SimulationOptions options;
  options.scene = "pole";
  options.seed = 4002;
  options.rate_hz = 15.0;
  const sim::Simulation simulation(options);
  const StereoGeometry geometry(simulation.calibration());
  Pipeline late(Config(), geometry, Rig()), low(Config(), geometry, Rig()), right(Config(), geometry, Rig());
  cv::Mat last = simulation.frame(9).right;
  for (std::size_t i = 10; i < 22; ++i) {
    StereoFrame pair = simulation.frame(i);
    EXPECT_FALSE(right.process(pair).verdict.reasons & kBadCalibration) << i;
    cv::swap(pair.right, last);
    EXPECT_TRUE(late.process(pair).verdict.reasons & kBadCalibration) << i;
    EXPECT_NE(late.query(late.box()).state, State::Free) << i;
    pair = simulation.frame(i);
    cv::warpAffine(pair.right, pair.right, cv::Matx23d(1, 0, 0, 0, 1, 3), pair.right.size());
    EXPECT_TRUE(low.process(pair).verdict.reasons & kBadCalibration) << i;
    for (const FreeArea& area : low.freeAreas().areas) EXPECT_NE(area.verdict.state, State::Free) << i;
  }
}

}  // namespace
}  // namespace flight_corridor
