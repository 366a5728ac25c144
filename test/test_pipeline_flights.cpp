#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "sim/random.hpp"
#include "sim/rig.hpp"
#include "sim/scene_parts.hpp"
#include "sim/simulation.hpp"
#include "sim/still.hpp"

// Simulated flights and scenes against their truth.

namespace flight_corridor {
namespace {

struct Answer {
  State state;
  sim::CorridorTruth truth;
};

std::vector<Answer> fly(const std::string& scene, double rate_hz, const Config& config) {
  sim::SimulationOptions options;
  options.scene = scene;
  options.seed = 3;
  options.rate_hz = rate_hz;
  const sim::Simulation simulation(options);
  Rig rig;
  rig.T_C_L = simulation.T_B_C().inverse() * simulation.T_B_L();
  Pipeline pipeline(config, StereoGeometry(simulation.calibration()), rig);
  const std::vector<RangeReading> ranges = simulation.ranges();
  auto next = ranges.begin();
  std::vector<Answer> answers;
  for (std::size_t i = 0; i < simulation.frameTimes().size(); ++i) {
    const StereoFrame frame = simulation.frame(i);
    for (; next != ranges.end() && next->stamp_s <= frame.stamp_s; ++next) pipeline.addRange(*next);
    const Eigen::Isometry3d T_W_C = simulation.T_W_B(frame.stamp_s) * simulation.T_B_C();
    answers.push_back({pipeline.process(frame, T_W_C).verdict.state, simulation.truth(i)});
  }
  return answers;
}

TEST(PipelineFlights, AWholeApproachAgreesWithTheTruth) {
  const std::vector<Answer> answers = fly("wall", 5.0, Config());
  int truly_free = 0, truly_blocked = 0, called_free = 0;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const auto& [state, truth] = answers[i];
    if (std::isfinite(truth.clear_exact_m)) {
      EXPECT_EQ(state, State::Blocked) << "frame " << i;
      ++truly_blocked;
    } else if (!std::isfinite(truth.clear_inflated_m) && i > 0) {
      EXPECT_NE(state, State::Unknown) << "frame " << i;
      ++truly_free;
      called_free += state == State::Free;
    }
  }
  EXPECT_GT(truly_blocked, 10);
  EXPECT_GT(truly_free, 10);
  EXPECT_GE(called_free, truly_free - 1) << "in the last of them the wall is 0.1 m behind the end";
}

/// A flight past a pole, seen by rigs that announce another calibration than theirs, or whose right images are moved.
TEST(PipelineFlights, ARigThatIsOutOfCalibrationIsNotFreeBeforeAPole) {
  sim::SimulationOptions options;
  options.scene = "pole";
  options.seed = 3;
  options.rate_hz = 2.0;
  const sim::Simulation simulation(options);
  Rig rig;
  rig.T_C_L = simulation.T_B_C().inverse() * simulation.T_B_L();
  std::vector<std::unique_ptr<Pipeline>> pipelines;
  for (const double factor : {1.0, 1.0, 1.0, 1.0, 1.2, 1.5}) {
    StereoCalibration announced = simulation.calibration();
    announced.baseline_m *= factor;
    pipelines.push_back(std::make_unique<Pipeline>(Config(), StereoGeometry(announced), rig));
  }
  const int shifts_px[] = {2, 4, 5, 8, 0, 0};
  const std::vector<RangeReading> ranges = simulation.ranges();
  auto next = ranges.begin();
  int blocked = 0;
  for (std::size_t i = 0; i < simulation.frameTimes().size(); ++i) {
    StereoFrame frame = simulation.frame(i);
    const cv::Mat right = frame.right;
    const bool is_blocked = std::isfinite(simulation.truth(i).clear_exact_m);
    blocked += is_blocked;
    const auto first = next;
    while (next != ranges.end() && next->stamp_s <= frame.stamp_s) ++next;
    for (std::size_t k = 0; k < pipelines.size(); ++k) {
      std::for_each(first, next, [&](const RangeReading& reading) { pipelines[k]->addRange(reading); });
      frame.right = cv::Mat();
      cv::warpAffine(right, frame.right, cv::Matx23d(1, 0, shifts_px[k], 0, 1, 0), right.size());
      const Verdict verdict = pipelines[k]->process(frame).verdict;
      EXPECT_FALSE(is_blocked && verdict.state == State::Free) << "rig " << k << " frame " << i;
      EXPECT_TRUE(verdict.reasons & kLidarNearer || i != 1 || k >= 3) << "rig " << k;
    }
  }
  EXPECT_GT(blocked, 5);
}

TEST(PipelineFlights, AMapThatRemembersHoldsWhatComesNearerThanStereoSees) {
  constexpr double kBlind_m = 0.3;  // f*B/num_disparities is 0.33 m
  Config config;
  config.map.frame_id = "odom";
  int blind = 0;
  for (const auto& [state, truth] : fly("close_pole", 4.0, config)) {
    EXPECT_EQ(state, State::Blocked) << truth.clear_exact_m << " m";
    blind += truth.clear_exact_m < kBlind_m;
  }
  EXPECT_GE(blind, 2);
}

/// By one frame of a flight alone.
Verdict verdictOn(const std::string& scene, std::uint64_t seed, double rate_hz, std::size_t frame,
                  double true_clear_m) {
  sim::SimulationOptions options;
  options.scene = scene;
  options.seed = seed;
  options.rate_hz = rate_hz;
  const sim::Simulation simulation(options);
  const double clear_m = simulation.truth(frame).clear_exact_m;
  EXPECT_TRUE(clear_m == true_clear_m || std::abs(clear_m - true_clear_m) < 0.001) << clear_m;
  Pipeline pipeline(Config(), StereoGeometry(simulation.calibration()), Rig());
  return pipeline.process(simulation.frame(frame)).verdict;
}

/// Matched as one with the leaves behind the end, 0.15 m too far.
TEST(PipelineFlights, ASmallThingBlocks) {
  EXPECT_EQ(verdictOn("small_thing", 240, 10.0, 47, 2.782).state, State::Blocked);
}

/// Nearly level, and of so little contrast that a window of 31 px shows no
/// edge.
TEST(PipelineFlights, ABranchNearlyAsGreyAsTheWallBlocks) {
  EXPECT_EQ(verdictOn("branch", 539, 4.0, 17, 3.493).state, State::Blocked);
}

/// 4 cm behind the end; what is matched of it is measured 0.3 m farther.
TEST(PipelineFlights, ALevelBranchThatMayBeInTheBoxIsNotFree) {
  const Verdict verdict = verdictOn("branch", 455, 4.0, 15, kInfinity);
  EXPECT_NE(verdict.state, State::Free) << describeReasons(verdict.reasons);
}

/// Its outline alone has matches, and is shorter in pixels than a face is
/// large: no cell of it is hit.
TEST(PipelineFlights, ABareBallBesideTheBeamIsNotFreeForBeingNear) {
  constexpr double kDistance_m = 1.0, kSize_m = 0.16, kInside_m = 0.08;
  const StereoGeometry geometry(sim::defaultRig().calibration);
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    sim::Random random(seed, sim::Stream::Scene);
    const Eigen::Vector3d middle_W(kDistance_m + kSize_m / 2.0, 0.6 - kInside_m + kSize_m / 2.0, sim::kHeight_m);
    const std::vector<sim::Primitive> world{sim::backdrop(8.0, sim::masonry(random)),
                                            sim::makeSphere(middle_W, kSize_m / 2.0, sim::plain(0.15))};
    Pipeline pipeline(Config(), geometry, Rig());
    const Verdict verdict = pipeline.process(sim::stillPair(world, seed)).verdict;
    EXPECT_NE(verdict.state, State::Free) << "seed " << seed << ": " << describeReasons(verdict.reasons);
  }
}

/// Nothing shows which of its periods is right, but a LiDAR whose beam ends
/// there.
TEST(PipelineFlights, AWallWithoutEndWhosePatternRepeatsItselfIsNotFree) {
  constexpr double kDistance_m = 2.5;
  const StereoGeometry geometry(sim::defaultRig().calibration);
  Rig rig;
  rig.T_C_L = opticalFromForward();
  for (const double period_m : {0.04, 0.05, 0.06, 0.07, 0.08}) {
    std::vector<sim::Primitive> world;
    for (int i = -110; i < 110; ++i) {
      world.push_back(sim::makeBox({kDistance_m + 0.01, i * period_m / 2.0, 1.5}, {0.02, period_m / 2.0, 30.0},
                                   sim::plain(i % 2 ? 0.2 : 0.7)));
    }
    const StereoFrame pair = sim::stillPair(world, 1);
    Pipeline pipeline(Config(), geometry, Rig()), with_lidar(Config(), geometry, rig);
    EXPECT_NE(pipeline.process(pair).verdict.state, State::Free) << period_m;
    for (int i = 4; i >= 0; --i) with_lidar.addRange({pair.stamp_s - 0.01 * i, kDistance_m, 0.2, 100.0, 0.03});
    EXPECT_EQ(with_lidar.process(pair).verdict.state, State::Blocked) << period_m;
  }
}

TEST(PipelineFlights, APatternThatTheLidarConfirmsIsMatched) {
  constexpr double kDistance_m = 4.5, kPeriod_m = 0.06;
  Rig rig;
  rig.T_C_L = opticalFromForward();
  std::vector<sim::Primitive> world;
  for (int i = -110; i < 110; ++i) {
    world.push_back(sim::makeBox({kDistance_m + 0.01, i * kPeriod_m / 2.0, 1.5}, {0.02, kPeriod_m / 2.0, 30.0},
                                 sim::plain(i % 2 ? 0.2 : 0.7)));
  }
  const StereoFrame pair = sim::stillPair(world, 1);
  const StereoGeometry geometry(sim::defaultRig().calibration);
  Pipeline alone(Config(), geometry, Rig()), pipeline(Config(), geometry, rig);
  EXPECT_TRUE(alone.process(pair).verdict.reasons & kNoDisparity);
  for (int i = 4; i >= 0; --i) pipeline.addRange({pair.stamp_s - 0.01 * i, kDistance_m, 0.2, 100.0, 0.03});
  EXPECT_FALSE(pipeline.process(pair).verdict.reasons & kNoDisparity);
}

TEST(PipelineFlights, WithoutASmallestObstacleASeenCorridorIsFreeStill) {
  Config config;
  config.corridor.smallest_obstacle_m = 0.0;
  int truly_free = 0, called_free = 0;
  for (const auto& [state, truth] : fly("wall", 2.0, config)) {
    truly_free += !std::isfinite(truth.clear_inflated_m);
    called_free += state == State::Free;
  }
  EXPECT_GT(truly_free, 3);
  EXPECT_GE(called_free, truly_free - 2);
}

/// Its readings of the last eighth of a second passed between the pickets, that of a fence behind the box.
TEST(PipelineFlights, ALidarThatMetAPatternDecidesUntilSomethingNearerIsMet) {
  constexpr std::size_t kFrame = 6;
  sim::SimulationOptions options;
  options.scene = "fence";
  options.seed = 1106;
  options.rate_hz = 4.0;
  const sim::Simulation simulation(options);
  Rig rig;
  rig.T_C_L = simulation.T_B_C().inverse() * simulation.T_B_L();
  const StereoFrame pair = simulation.frame(kFrame);
  const RangeReading nearer{pair.stamp_s, 3.0, 0.2, 100.0, 0.03};
  for (const bool meets_nearer : {false, true}) {
    Pipeline pipeline(Config(), StereoGeometry(simulation.calibration()), rig);
    for (const RangeReading& reading : simulation.ranges()) {
      if (reading.stamp_s <= pair.stamp_s) pipeline.addRange(reading);
    }
    if (meets_nearer) pipeline.addRange(nearer);
    const Report& report = pipeline.process(pair);
    EXPECT_EQ(reasonsOf(report) & kLidarRejected, kLidarRejected);
    EXPECT_EQ((report.verdict.reasons & kAmbiguous) != 0, meets_nearer) << describeReasons(report.verdict.reasons);
    EXPECT_EQ(report.verdict.state, meets_nearer ? State::Unknown : State::Free);
  }
}

/// Each bar fits on the next one, as far away as the wall; the LiDAR's beam
/// passes between them.
TEST(PipelineFlights, ARailingWhoseBarsFitOnTheWallIsNotFree) {
  constexpr double kDistance_m = 2.5, kWall_m = 6.0, kBar_m = 0.02;
  const sim::Rig rig = sim::defaultRig();
  const double pitch_m = rig.calibration.baseline_m * (1.0 - kDistance_m / kWall_m);
  Rig with_lidar;
  with_lidar.T_C_L = opticalFromForward();
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    sim::Random random(seed, sim::Stream::Scene);
    std::vector<sim::Primitive> world{sim::backdrop(kWall_m, sim::masonry(random))};
    const sim::Material paint = sim::textured(random, 0.4, 0.2, 0.16);
    for (int i = -60; i < 60; ++i) {
      const Eigen::Vector3d middle_W(kDistance_m + 0.01, (i + 0.5) * pitch_m, sim::kHeight_m);
      world.push_back(sim::makeBox(middle_W, {0.02, kBar_m, 1.0}, paint));
    }
    const StereoFrame pair = sim::stillPair(world, seed);
    Pipeline pipeline(Config(), StereoGeometry(rig.calibration), with_lidar);
    for (int i = 4; i >= 0; --i) pipeline.addRange({pair.stamp_s - 0.01 * i, kWall_m, 0.2, 100.0, 0.03});
    const Verdict verdict = pipeline.process(pair).verdict;
    EXPECT_EQ(verdict.state, State::Unknown) << seed << ": " << describeReasons(verdict.reasons);
    EXPECT_EQ(verdict.reasons & kAmbiguous, kAmbiguous) << seed;
  }
}

}  // namespace
}  // namespace flight_corridor
