#include <gtest/gtest.h>
#include <ros/time.h>

#include "ros/transforms.hpp"

namespace flight_corridor_ros {
namespace {

class TransformsTest : public testing::Test {
 protected:
  TransformsTest() { ros::Time::init(); }
  ~TransformsTest() override { ros::Time::init(); }  // the system's clock again

  void hearAt(double now_s) {
    ros::Time::setNow(ros::Time(now_s));
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    geometry_msgs::TransformStamped& pose = message.transforms[0];
    pose.header.stamp = ros::Time(now_s);
    pose.header.frame_id = "odom";
    pose.child_frame_id = "base_link";
    pose.transform.rotation.w = 1.0;
    transforms.receive(message, false);
  }
  bool isKnown(double stamp_s) const { return transforms.find("odom", "base_link", ros::Time(stamp_s)).has_value(); }

  Transforms transforms;
};

TEST_F(TransformsTest, AClockThatIsSetBackALittleForgetsNoPose) {
  hearAt(100.0);
  hearAt(100.0 - 1e-6);
  EXPECT_TRUE(isKnown(100.0));
}

TEST_F(TransformsTest, AClockThatIsSetBackForgetsThePosesOfTheOtherTime) {
  hearAt(100.0);
  hearAt(50.0);
  EXPECT_FALSE(isKnown(100.0));
  EXPECT_TRUE(isKnown(50.0));
}

}  // namespace
}  // namespace flight_corridor_ros
