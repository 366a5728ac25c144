#include <gtest/gtest.h>
#include <ros/time.h>

#include <cmath>
#include <vector>

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

nav_msgs::Odometry odometryAt(double stamp_s, double x_m) {
  nav_msgs::Odometry odometry;
  odometry.header.stamp = ros::Time(stamp_s);
  odometry.header.frame_id = "odom";
  odometry.child_frame_id = "/base_link";
  odometry.pose.pose.position.x = x_m;
  odometry.pose.pose.orientation.z = std::sin(0.3);
  odometry.pose.pose.orientation.w = std::cos(0.3);
  return odometry;
}

TEST_F(TransformsTest, OdometryTellsTheMotionOfABodyThatTfMovesInAnotherFrame) {
  hearAt(100.0);  // base_link has a parent, odom
  EXPECT_FALSE(transforms.hasOdometry());
  for (const double stamp_s : {100.0, 100.2}) transforms.receive(odometryAt(stamp_s, stamp_s));
  EXPECT_TRUE(transforms.hasOdometry());
  const auto T_W_B = transforms.find(Transforms::kOdometryFrame, "base_link", ros::Time(100.1));
  ASSERT_TRUE(T_W_B);
  EXPECT_NEAR(T_W_B->translation().x(), 100.1, 1e-6);
  EXPECT_NEAR(Eigen::AngleAxisd(T_W_B->linear()).angle(), 0.6, 1e-6);
  EXPECT_TRUE(isKnown(100.0)) << "tf's own";
}

TEST_F(TransformsTest, OdometryWithoutBodyPoseOrStampIsLeftOut) {
  std::vector<nav_msgs::Odometry> broken(4, odometryAt(100.0, 1.0));
  broken[0].child_frame_id = "";
  broken[1].pose.pose.orientation = geometry_msgs::Quaternion();
  broken[2].pose.pose.position.y = std::nan("");
  broken[3].header.stamp = ros::Time();
  for (const nav_msgs::Odometry& odometry : broken) transforms.add(odometry);
  EXPECT_FALSE(transforms.hasOdometry());
}

}  // namespace
}  // namespace flight_corridor_ros
