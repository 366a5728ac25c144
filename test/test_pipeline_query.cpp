#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "support/calibrations.hpp"
#include "support/parallel_wires.hpp"
#include "support/pipeline_inputs.hpp"
#include "support/wall_scene.hpp"

namespace flight_corridor {
namespace {

using namespace test_support;

TEST(PipelineQuery, AQueryIsAnsweredFromTheLastPair) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  EXPECT_EQ(pipeline.query(ahead(1.0, 2.5)).reasons, kNoData);
  pipeline.process(wallFrame(kSmallGeometry, 3, 1.0));  // 7 m
  const Verdict free = pipeline.query(ahead(1.0, 2.5));
  EXPECT_EQ(free.state, State::Free) << describeReasons(free.reasons) << " " << free.unknown_fraction;
  EXPECT_EQ(free.clear_distance_m, kInfinity);
  EXPECT_EQ(free.stamp_s, 1.0);
  pipeline.process(wallFrame(kSmallGeometry, 7, 1.1));  // 3 m
  const Verdict blocked = pipeline.query(ahead(1.0, 2.5));
  EXPECT_EQ(blocked.state, State::Blocked);
  EXPECT_TRUE(blocked.reasons & kOccupiedCell);
  EXPECT_NEAR(blocked.clear_distance_m, 2.0, 0.1 + 0.03 * 3.0);  // one voxel + 3 %
  EXPECT_EQ(pipeline.query(ahead(1.0, 2.5)).clear_distance_m, blocked.clear_distance_m);
}

TEST(PipelineQuery, AQueryExemptsNothingThatTheCameraCannotSee) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  ASSERT_EQ(pipeline.process(wallFrame(kSmallGeometry, 3, 1.0)).verdict.state, State::Free);
  for (const Box& box : {ahead(0.0, 0.4), ahead(-3.0, 2.0), ahead(7.5, 2.0)}) {
    const Verdict verdict = pipeline.query(box);
    EXPECT_EQ(verdict.state, State::Unknown);
    EXPECT_TRUE(verdict.reasons & kUnobserved);
    EXPECT_GT(verdict.unknown_fraction, 0.1);
  }
}

TEST(PipelineQuery, AQueryIsNeverFreeAfterAFrameThatShowsNothing) {
  Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  const StereoFrame good = wallFrame(kSmallGeometry, 3, 1.0);
  pipeline.process(good);
  ASSERT_EQ(pipeline.query(ahead(1.0, 2.5)).state, State::Free);
  StereoFrame frozen = good, refused = good;
  frozen.stamp_s = refused.stamp_s = 1.1;
  refused.left = cv::Mat();
  pipeline.process(frozen);
  EXPECT_EQ(pipeline.query(ahead(1.0, 2.5)).reasons, kFrozenImage);
  EXPECT_EQ(pipeline.query(ahead(1.0, 2.5)).state, State::Unknown);
  pipeline.process(refused);
  EXPECT_EQ(pipeline.query(ahead(1.0, 2.5)).reasons, kBadImage);
  EXPECT_EQ(pipeline.query(ahead(1.0, 2.5)).state, State::Unknown);
}

TEST(PipelineQuery, AQueryOfWiresThatFitOnEachOtherIsNotFree) {
  const ParallelWires wires;
  Pipeline pipeline(Config(), wires.geometry, Rig());
  pipeline.process(wires.frame);
  EXPECT_NE(pipeline.query(ahead(1.0, 2.5)).state, State::Free);
}

TEST(PipelineQuery, QueriesOfImpossibleBoxesSayWhatIsWrong) {
  const Pipeline pipeline(Config(), kSmallGeometry, rigWithLidar());
  try {
    pipeline.query(ahead(kNaN, -1.0));
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("box/position: finite (nan)"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("box/length_m: above 0, up to 100 (-1)"), std::string::npos);
  }
}

}  // namespace
}  // namespace flight_corridor
