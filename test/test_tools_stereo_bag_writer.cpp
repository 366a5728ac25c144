#include <gtest/gtest.h>
#include <rosbag/view.h>

#include "ros/conversions.hpp"
#include "support/small_flight.hpp"
#include "tools/stereo_bag_reader.hpp"
#include "tools/stereo_bag_writer.hpp"

namespace flight_corridor::tools {
namespace {

using test_support::kStart;

class StereoBagWriterTest : public test_support::SmallFlightTest {};

TEST_F(StereoBagWriterTest, CalibrationSurvivesAlsoWithPrincipalPointsThatDiffer) {
  writeFlight();
  StereoBagReader(path(), {})
      .play({}, {[&](const StereoMessages& pair) {
                   const StereoCalibration read = flight_corridor_ros::toCalibration(*pair.left_info, *pair.right_info);
                   EXPECT_EQ(read.size_px, rig.calibration.size_px);
                   EXPECT_EQ(read.fx_px, 10.0);
                   EXPECT_EQ(read.fy_px, 10.0);
                   EXPECT_EQ(read.cx_px, 4.0);
                   EXPECT_EQ(read.cy_px, 3.0);
                   EXPECT_EQ(read.cx_right_px, 5.5);
                   EXPECT_NEAR(read.baseline_m, 0.12, 1e-15);
                 },
                 [](const sensor_msgs::RangeConstPtr&) {}, [](const sensor_msgs::ImuConstPtr&) {}});
}

TEST_F(StereoBagWriterTest, StaticTransformsAreLatched) {
  writeFlight();
  rosbag::Bag bag(path(), rosbag::bagmode::Read);
  rosbag::View view(bag, rosbag::TopicQuery("/tf_static"));
  ASSERT_EQ(view.size(), 1u);
  EXPECT_EQ(view.getConnections().front()->header->at("latching"), "1");
}

TEST_F(StereoBagWriterTest, NamesAFileThatCannotBeWritten) {
  EXPECT_THROW(StereoBagWriter("/no/such/folder/a.bag", rig, kStart), std::runtime_error);
}

}  // namespace
}  // namespace flight_corridor::tools
