#include <gtest/gtest.h>
#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "support/contains.hpp"
#include "support/processor_test.hpp"

namespace flight_corridor_ros {
namespace {

using namespace flight_corridor;
using namespace test_support;
using flight_corridor::test_support::contains;

TEST_F(ProcessorTest, APairWithoutAStampIsNoData) {
  EXPECT_EQ(see(kFar_m, ros::Time(), 1).reasons, kNoData);
  EXPECT_EQ(see(kFar_m, kStart, 2).state, State::Free);
}

TEST_F(ProcessorTest, WhoseImagesMissTheSmallestObstacleIsWarned) {
  const auto warningWith = [this](double smallest_obstacle_m) {
    config.core.corridor.smallest_obstacle_m = smallest_obstacle_m;
    Processor fresh(config, transforms, inbox);
    StereoInputs inputs(kFar_m);
    inputs.stamp(kStart);
    testing::internal::CaptureStderr();
    fresh.process(messages(inputs));
    return testing::internal::GetCapturedStderr();
  };
  const double f_px = StereoInputs(kFar_m).left_info.P[0];
  const double narrowest_m = 3.0 / f_px * config.core.corridor.length_m;
  EXPECT_TRUE(contains(warningWith(0.9 * narrowest_m), "2.7 px wide at the corridor's end"));
  EXPECT_EQ(warningWith(1.1 * narrowest_m), "");
}

TEST_F(ProcessorTest, RangesOfOtherFramesAreNotTheLidars) {
  putRange("range_link", kFar_m, kStart);
  ASSERT_EQ(see(kFar_m, kStart, 1).state, State::Free);
  for (int i = 1; i < 5; ++i) {
    const ros::Time stamp = kStart + ros::Duration(0.1 * i);
    putRange("range_link", kFar_m, stamp);
    putRange("range_down", 1.0, stamp);
    const Verdict verdict = see(kFar_m, stamp, 1 + static_cast<std::uint64_t>(i));
    EXPECT_EQ(verdict.state, State::Free) << describeReasons(verdict.reasons);
    EXPECT_FALSE(verdict.reasons & kLidarRejected);
  }
}

TEST_F(ProcessorTest, ALidarThatTfDoesNotKnowGivesNoFusedRangeAFrame) {
  putRange("range_down", kFar_m, kStart);
  EXPECT_TRUE(see(kFar_m, kStart, 1).reasons & kNoLidar);
  EXPECT_FALSE(processor.lidar());
}

TEST_F(ProcessorTest, TheLidarIsTheOneWhoseBeamEndsInViewWhicheverComesLast) {
  mount("range_down", M_PI_2);
  mount("range_back", M_PI);
  for (int i = 0; i < 3; ++i) {
    const ros::Time stamp = kStart + ros::Duration(0.1 * i);
    putRange("range_down", 1.5, stamp);
    putRange("range_link", kFar_m, stamp);
    putRange("/range_back", 1.2, stamp);
    EXPECT_EQ(see(kFar_m, stamp, 1 + static_cast<std::uint64_t>(i)).state, State::Free);
    EXPECT_NEAR(processor.report().range_lidar_m, kFar_m, 1e-6);
    ASSERT_TRUE(processor.lidar());
    EXPECT_EQ(processor.lidar()->header.frame_id, "range_link");
  }
}

TEST_F(ProcessorTest, ADownwardRangefinderAloneIsNoLidar) {
  mount("range_down", M_PI_2);
  putRange("range_down", 1.5, kStart);
  const Verdict verdict = see(kFar_m, kStart, 1);
  EXPECT_EQ(verdict.state, State::Free);
  EXPECT_TRUE(verdict.reasons & kNoLidar);
}

TEST_F(ProcessorTest, AMountingThatIsSentAgainWithOtherNumbersCounts) {
  const auto seeAt = [&](double after_s, double range_m) {
    const ros::Time stamp = kStart + ros::Duration(after_s);
    putRange("range_link", range_m, stamp);
    see(kFar_m, stamp, 1 + static_cast<std::uint64_t>(10.0 * after_s));
    return processor.report();
  };
  EXPECT_NEAR(seeAt(0.0, kFar_m).range_stereo_m, kFar_m, 0.05);
  geometry_msgs::TransformStamped moved = tf2::eigenToTransform(Eigen::Translation3d(0, 0, 0.5) * opticalFromForward());
  moved.header.frame_id = "left_optical";
  moved.child_frame_id = "range_link";
  transforms.add(moved, true);
  EXPECT_NEAR(seeAt(0.1, kFar_m - 0.5).range_stereo_m, kFar_m - 0.5, 0.05);
  EXPECT_EQ(processor.counters().frames, 2u) << "by one pipeline: the map stays";
  mount("range_link", M_PI_2);  // looks aside now
  EXPECT_TRUE(seeAt(1.0, 1.5).verdict.reasons & kNoLidar);
  EXPECT_FALSE(processor.lidar());
}

TEST_F(ProcessorTest, ReadingsWithImpossibleStampsAreRefusedAndCounted) {
  for (int i = 0; i < 4; ++i) {
    const ros::Time stamp = kStart + ros::Duration(0.1 * i);
    putRange("range_link", kFar_m, stamp);
    putRange("range_link", 1.0, ros::Time());
    putRange("range_link", 1.0, ros::Time(37.0 + i));
    putRange("range_link", 1.0, stamp + ros::Duration(3600.0));
    EXPECT_EQ(see(kFar_m, stamp, 1 + static_cast<std::uint64_t>(i)).state, State::Free);
    EXPECT_NEAR(processor.report().range_lidar_m, kFar_m, 1e-6);
  }
  EXPECT_EQ(processor.counters().refused, 9u) << "three a pair, but for the first, before which there was no time";
}

TEST_F(ProcessorTest, FramesOfTheFirstGenerationGoOutAsTf2TakesThem) {
  StereoInputs inputs(kFar_m, 1);
  inputs.stamp(kStart);
  inputs.left->header.frame_id = "/left_optical";
  putRange("/range_link", kFar_m, kStart);
  EXPECT_EQ(processor.process(messages(inputs)).verdict.state, State::Free);
  EXPECT_NEAR(processor.report().range_lidar_m, kFar_m, 1e-6);
  EXPECT_EQ(processor.mapHeader().frame_id, "left_optical");
}

TEST_F(ProcessorTest, ABaselineInMillimetresIsABadCalibrationAlsoForTheFirstPair) {
  for (const double factor : {1000.0, 100.0, 1.0 / 0.0254}) {
    StereoInputs inputs(kNear_m, 1);
    inputs.stamp(kStart);
    inputs.right_info.P[3] *= factor;
    putRange("range_link", kNear_m, kStart);
    processor.reset();
    EXPECT_EQ(processor.process(messages(inputs)).verdict.reasons, kBadCalibration) << factor;
  }
}

TEST_F(ProcessorTest, RowsThatDisagreeAreABadCalibrationUntilTimeStartsAnew) {
  StereoInputs low(kFar_m, 1);
  low.stamp(kStart);
  std::rotate(low.right->data.begin(), low.right->data.end() - 4 * low.right->step, low.right->data.end());
  EXPECT_TRUE(processor.process(messages(low)).verdict.reasons & kBadCalibration);
  EXPECT_EQ(processor.report().rows.fault, flight_corridor::RowFault::Offset);
  EXPECT_EQ(processor.products(), nullptr);
  EXPECT_NE(see(kFar_m, kStart + ros::Duration(0.1), 2).state, State::Free) << "one pair of two";
  processor.reset();
  EXPECT_EQ(see(kFar_m, kStart + ros::Duration(0.2), 3).state, State::Free);
}

TEST_F(ProcessorTest, ImagesOfHalfTheCalibrationsSizeAreBadImages) {
  StereoInputs inputs(kFar_m, 1);
  inputs.stamp(kStart);
  for (const auto& image : {inputs.left, inputs.right}) {
    image->width /= 2;
    image->height /= 2;
  }
  EXPECT_EQ(processor.process(messages(inputs)).verdict.reasons, kBadImage);
}

TEST_F(ProcessorTest, AStampAtTheEndOfTimeIsNoPoseAndEndsNothing) {
  mount("gimbal", 0.0, ros::Time(4294967295u, 0));
  EXPECT_FALSE(transforms.find("left_optical", "gimbal", ros::Time(0)));
  EXPECT_FALSE(transforms.find("left_optical", "range_link", ros::Time(4294967295u, 0)));
  EXPECT_TRUE(transforms.find("left_optical", "range_link", kStart));
}

TEST_F(ProcessorTest, APoseOfAnotherCenturyIsNoPose) {
  mount("odom", 0.0, ros::Time(3000000000u, 0));
  EXPECT_FALSE(transforms.find("left_optical", "odom", kStart));
}

TEST_F(ProcessorTest, ACalibrationThatJittersHidesNoFrozenCamera) {
  see(kFar_m, kStart, 1);
  for (int i = 1; i < 4; ++i) {
    principal_point_px = 1e-9 * i;
    EXPECT_TRUE(see(kFar_m, kStart + ros::Duration(0.1 * i), 1).reasons & kFrozenImage);
  }
  EXPECT_EQ(processor.counters().frames, 4u) << "all by one pipeline";
}

TEST_F(ProcessorTest, AnotherCalibrationForgetsNeitherImagesNorTheHoldTime) {
  ASSERT_EQ(see(kNear_m, kStart, 1).state, State::Blocked);
  principal_point_px = 1.0;
  EXPECT_TRUE(see(kFar_m, kStart + ros::Duration(0.1), 2).reasons & kRecentlyBlocked);
  principal_point_px = 2.0;
  EXPECT_TRUE(see(kFar_m, kStart + ros::Duration(0.5), 2).reasons & kFrozenImage);
}

TEST_F(ProcessorTest, AnImpossibleCalibrationBetweenForgetsNothingEither) {
  ASSERT_EQ(see(kNear_m, kStart, 1).state, State::Blocked);
  StereoInputs blind(kFar_m, 2);
  blind.stamp(kStart + ros::Duration(0.05));
  blind.right_info.P[3] = 0.0;
  EXPECT_EQ(processor.process(messages(blind)).verdict.reasons, kBadCalibration);
  EXPECT_EQ(processor.pipeline(), nullptr);
  EXPECT_TRUE(see(kNear_m, kStart + ros::Duration(0.1), 1).reasons & kFrozenImage) << "by the pipeline of before";
  EXPECT_EQ(processor.counters().frames, 2u);
  blind.stamp(kStart + ros::Duration(0.15));
  processor.process(messages(blind));
  principal_point_px = 1.0;
  EXPECT_TRUE(see(kFar_m, kStart + ros::Duration(0.2), 3).reasons & kRecentlyBlocked) << "by another";
}

TEST_F(ProcessorTest, ACorridorThatIsSetDuringAnImpossibleCalibrationCountsAfterIt) {
  ASSERT_EQ(see(kNear_m, kStart, 1).state, State::Blocked);
  StereoInputs blind(kFar_m, 2);
  blind.stamp(kStart + ros::Duration(0.05));
  blind.right_info.P[3] = 0.0;
  processor.process(messages(blind));
  CorridorConfig shorter = config.core.corridor;
  shorter.length_m = kNear_m - 1.0;
  processor.setCorridor(shorter);
  EXPECT_NE(see(kNear_m, kStart + ros::Duration(0.1), 3).state, State::Blocked);
  EXPECT_EQ(processor.counters().frames, 2u) << "by the pipeline of before";
}

TEST_F(ProcessorTest, ALidarFoundInAPairWithoutAPoseIsUsedInTheNext) {
  config.core.corridor.frame_id = "forward";
  Processor turning(config, transforms, inbox);
  const auto show = [&](double after_s) {
    StereoInputs inputs(kFar_m, static_cast<std::uint64_t>(1.0 + 10.0 * after_s));
    inputs.stamp(kStart + ros::Duration(after_s));
    return turning.process(messages(inputs));
  };
  mount("forward", 0.0, kStart);
  mount("forward", 0.0, kStart + ros::Duration(0.1));
  EXPECT_TRUE(show(0.1).verdict.reasons & kNoLidar);
  putRange("range_link", kFar_m, kStart + ros::Duration(0.2));
  EXPECT_EQ(show(0.2).verdict.reasons, kNoPose);
  mount("forward", 0.0, kStart + ros::Duration(0.3));
  putRange("range_link", kFar_m, kStart + ros::Duration(0.3));
  EXPECT_NEAR(show(0.3).range_lidar_m, kFar_m, 1e-6);
  ASSERT_TRUE(turning.lidar());
  EXPECT_EQ(turning.lidar()->header.frame_id, "range_link");
}

TEST_F(ProcessorTest, AQuaternionTypedWithTwoDigitsIsARotation) {
  geometry_msgs::TransformStamped typed;
  typed.header.frame_id = "left_optical";
  typed.child_frame_id = "forward";
  typed.transform.rotation.x = typed.transform.rotation.w = 0.71;  // norm 1.004; tf takes it
  transforms.add(typed, true);
  const auto pose = transforms.find("left_optical", "forward", ros::Time(0));
  ASSERT_TRUE(pose);
  EXPECT_TRUE(pose->linear().isApprox(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitX()).matrix(), 1e-12));
}

TEST_F(ProcessorTest, TheCorridorTurnsWithItsFrame) {
  config.core.corridor.frame_id = "forward";
  Processor turning(config, transforms, inbox);
  const auto box = [&](double after_s, double left_rad) {
    const ros::Time stamp = kStart + ros::Duration(after_s);
    mount("forward", left_rad, stamp);
    StereoInputs inputs(kFar_m, static_cast<std::uint64_t>(1.0 + 10.0 * after_s));
    inputs.stamp(stamp);
    turning.process(messages(inputs));
    return turning.pipeline()->boxInCamera().T_M_F;
  };
  EXPECT_TRUE(box(0.0, 0.3).linear().col(0).isApprox(Eigen::Vector3d(-std::sin(0.3), 0.0, std::cos(0.3)), 1e-6));
  EXPECT_TRUE(box(0.1, 0.0).linear().col(0).isApprox(Eigen::Vector3d::UnitZ(), 1e-6));

  StereoInputs inputs(kFar_m, 3);
  inputs.stamp(kStart + ros::Duration(0.2));
  EXPECT_EQ(turning.process(messages(inputs)).verdict.reasons, kNoPose) << "tf does not know yet where it points";
}

}  // namespace
}  // namespace flight_corridor_ros
