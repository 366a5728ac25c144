#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/Range.h>

#include <stdexcept>

#include "support/temporary_folder.hpp"
#include "tools/bag_file.hpp"
#include "tools/topic_finder.hpp"

namespace flight_corridor::tools {
namespace {

const StereoTopics kNothingNamed{"", "", "", "", "", "", ""};

class TopicFinderTest : public testing::Test {
 protected:
  std::string path() const { return folder.path("a.bag"); }

  /// Two messages on each topic; of the type that its name says.
  void write(const std::vector<std::string>& topics) const {
    rosbag::Bag bag(path(), rosbag::bagmode::Write);
    for (const double stamp_s : {1.0, 1.5}) {
      for (const std::string& topic : topics) {
        const ros::Time stamp(stamp_s);
        if (topic.find("info") != std::string::npos) {
          bag.write(topic, stamp, sensor_msgs::CameraInfo());
        } else if (topic.find("imu") != std::string::npos) {
          bag.write(topic, stamp, sensor_msgs::Imu());
        } else if (topic.find("odom") != std::string::npos) {
          bag.write(topic, stamp, nav_msgs::Odometry());
        } else if (topic.find("range") != std::string::npos) {
          bag.write(topic, stamp, sensor_msgs::Range());
        } else if (topic.find("compressed") != std::string::npos) {
          bag.write(topic, stamp, sensor_msgs::CompressedImage());
        } else {
          sensor_msgs::Image image;
          image.encoding = topic.find("16UC1") == std::string::npos ? "mono8" : "16UC1";
          bag.write(topic, stamp, image);
        }
      }
    }
  }

  StereoTopics find(const StereoTopics& named = kNothingNamed, bool needs_info = false) const {
    rosbag::Bag bag;
    openBag(path(), bag);
    return findTopics(bag, named, needs_info);
  }

  std::string error(const StereoTopics& named = kNothingNamed, bool needs_info = false) const {
    try {
      find(named, needs_info);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  }

  test_support::TemporaryFolder folder;
};

TEST_F(TopicFinderTest, FindsThePairsThatDriversWrite) {
  for (const auto& [left, right] :
       {std::pair("/cam0/image_raw", "/cam1/image_raw"),
        std::pair("/camera/infra1/image_rect_raw", "/camera/infra2/image_rect_raw"),
        std::pair("/zed/zed_node/left/image_rect_color", "/zed/zed_node/right/image_rect_color"),
        std::pair("/camera_left/left_image", "/camera_right/right_image"), std::pair("/rig/l/image", "/rig/r/image"),
        std::pair("/cam0/image0", "/cam1/image1"),
        std::pair("/camera/fisheye1/image_raw", "/camera/fisheye2/image_raw")}) {
    write({left, right, "/camera/depth/image_rect_raw", "/camera/colour/image"});
    const StereoTopics topics = find();
    EXPECT_EQ(topics.left, left);
    EXPECT_EQ(topics.right, right);
  }
}

TEST_F(TopicFinderTest, ARigMayBeCalledDepth) {
  for (const auto& [left, right] : {std::pair("/depth_rig/left/image_rect", "/depth_rig/right/image_rect"),
                                    std::pair("/uav1/depth/left/image_raw", "/uav1/depth/right/image_raw"),
                                    std::pair("/disparity/cam0/image_raw", "/disparity/cam1/image_raw"),
                                    std::pair("/depth_rig/image_left", "/depth_rig/image_right")}) {
    write({left, right});
    EXPECT_EQ(find().left, left);
    EXPECT_EQ(find().right, right);
  }
}

TEST_F(TopicFinderTest, DepthImagesAreNoPair) {
  const std::string left = "/rig/left/image_raw", right = "/rig/right/image_raw";
  for (const auto& [other_left, other_right] :
       {std::pair("/depth1/image_rect", "/depth2/image_rect"), std::pair("/rig/left/depth", "/rig/right/depth"),
        std::pair("/l/Disparity/image_rect", "/r/Disparity/image_rect"),
        std::pair("/rig/left/image_16UC1", "/rig/right/image_16UC1"),
        std::pair("/cam1/image_rect/compressedDepth", "/cam2/image_rect/compressedDepth")}) {
    write({left, right, other_left, other_right});
    EXPECT_EQ(find().left, left) << other_left;
    EXPECT_EQ(find().right, right) << other_left;
  }
  write({"/rig/left/image_16UC1", "/rig/right/image_16UC1"});
  EXPECT_NE(error().find("no two image topics"), std::string::npos) << error();
}

TEST_F(TopicFinderTest, TakesRectifiedImagesBeforeRawAndGreyBeforeColour) {
  write({"/s/left/image_raw", "/s/right/image_raw", "/s/left/image_rect", "/s/right/image_rect",
         "/s/left/image_rect_color", "/s/right/image_rect_color"});
  EXPECT_EQ(find().left, "/s/left/image_rect");
}

TEST_F(TopicFinderTest, CompressedImagesCountByTheNameOfTheRawOnes) {
  write({"/s/left/image_raw", "/s/left/image_raw/compressed", "/s/right/image_raw/compressed"});
  EXPECT_EQ(find().left, "/s/left/image_raw");
  EXPECT_EQ(find().right, "/s/right/image_raw");
}

TEST_F(TopicFinderTest, ListsSeveralPairsAndTheOptionsThatNameThem) {
  write({"/cam0/image_raw", "/cam1/image_raw", "/cam2/image_raw"});
  const std::string text = error();
  EXPECT_NE(text.find("\n  --left /cam0/image_raw --right /cam1/image_raw"), std::string::npos) << text;
  EXPECT_NE(text.find("\n  --left /cam1/image_raw --right /cam2/image_raw"), std::string::npos) << text;
  StereoTopics named = kNothingNamed;
  named.left = "/cam1/image_raw";
  EXPECT_EQ(find(named).right, "/cam2/image_raw");
}

TEST_F(TopicFinderTest, SaysWhatThereIsWhereThereIsNoPair) {
  write({"/front/image_raw", "/range"});
  EXPECT_NE(error().find("--left TOPIC"), std::string::npos) << error();
  EXPECT_NE(error().find("/front/image_raw sensor_msgs/Image"), std::string::npos) << error();
}

TEST_F(TopicFinderTest, TheInfosLieBesideTheImages) {
  write({"/cam0/image_raw", "/cam1/image_raw", "/cam0/camera_info", "/cam1/camera_info"});
  EXPECT_EQ(find(kNothingNamed, true).right_info, "/cam1/camera_info");
  write({"/cam0/image_raw", "/cam1/image_raw"});
  EXPECT_NE(error(kNothingNamed, true).find("--calib FILE"), std::string::npos) << error(kNothingNamed, true);
  EXPECT_EQ(error(), "") << "with a calibration none is needed";
}

TEST_F(TopicFinderTest, TheOnlyRangeImuAndOdometryAreTaken) {
  write({"/cam0/image_raw", "/cam1/image_raw", "/mavros/range_down", "/imu0", "/vio/odom"});
  EXPECT_EQ(find().odom, "/vio/odom");
  EXPECT_EQ(find().range, "/mavros/range_down");
  EXPECT_EQ(find().imu, "/imu0");
  write({"/cam0/image_raw", "/cam1/image_raw", "/range_a", "/range_b", "/imu_a", "/imu_b", "/odom_a", "/odom_b"});
  EXPECT_NE(error().find("\n  --range /range_a\n  --range /range_b"), std::string::npos) << error();
  StereoTopics named = kNothingNamed;
  named.range = "none";
  EXPECT_EQ(find(named).range, "");
  EXPECT_EQ(find(named).imu, "");
  EXPECT_EQ(find(named).odom, "");
}

TEST_F(TopicFinderTest, TheUsualTopicsComeFirst) {
  const StereoTopics usual;
  write({usual.left, usual.right, usual.left_info, usual.right_info, usual.range, usual.imu, "/cam0/image_rect",
         "/cam1/image_rect", "/range_b", "/imu_b"});
  const StereoTopics found = find(kNothingNamed, true);
  EXPECT_EQ(found.left, usual.left);
  EXPECT_EQ(found.right_info, usual.right_info);
  EXPECT_EQ(found.range, usual.range);
  EXPECT_EQ(found.imu, usual.imu);
}

TEST_F(TopicFinderTest, ListsTopicsWithTypeCountAndRate) {
  write({"/cam0/image_raw", "/range"});
  rosbag::Bag bag;
  openBag(path(), bag);
  const std::string list = listTopics(bag);
  EXPECT_NE(list.find("       2      2.00 Hz  /cam0/image_raw  sensor_msgs/Image\n"), std::string::npos) << list;
}

TEST(IsNamedRectified, AsksWordsOfTheName) {
  EXPECT_TRUE(isNamedRectified("/camera/infra1/image_rect_raw"));
  EXPECT_TRUE(isNamedRectified("/left_rectified/image"));
  EXPECT_FALSE(isNamedRectified("/direct/image_raw"));
  EXPECT_FALSE(isNamedRectified("/left/image_unrectified"));
}

}  // namespace
}  // namespace flight_corridor::tools
