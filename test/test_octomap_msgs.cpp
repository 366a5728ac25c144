#include <gtest/gtest.h>
#include <octomap_msgs/BoundingBoxQuery.h>
#include <octomap_msgs/GetOctomap.h>
#include <octomap_msgs/Octomap.h>
#include <octomap_msgs/OctomapWithPose.h>
#include <ros/message_traits.h>
#include <ros/service_traits.h>

// Programs built against another octomap_msgs only talk to ours when these agree.

TEST(OctomapMsgs, MessagesHaveTheWireFormatThatOthersKnow) {
  EXPECT_STREQ(ros::message_traits::md5sum<octomap_msgs::Octomap>(), "9a45536b45c5e409cd49f04bb2d9999f");
  EXPECT_STREQ(ros::message_traits::md5sum<octomap_msgs::OctomapWithPose>(), "20b380aca6a508a657e95526cddaf618");
}

TEST(OctomapMsgs, ServicesHaveTheWireFormatThatOthersKnow) {
  EXPECT_STREQ(ros::service_traits::md5sum<octomap_msgs::GetOctomap>(), "be9d2869d24fe40d6bc21ac21f6bb2c5");
  EXPECT_STREQ(ros::service_traits::md5sum<octomap_msgs::BoundingBoxQuery>(), "93aa3d73b866f04880927745f4aab303");
}
