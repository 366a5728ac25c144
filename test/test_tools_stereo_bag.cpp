#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <sensor_msgs/image_encodings.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "flight_corridor/corridor.hpp"
#include "ros/conversions.hpp"
#include "support/temporary_folder.hpp"
#include "tools/stereo_bag.hpp"

namespace flight_corridor::tools {
namespace {

namespace fs = std::filesystem;

const ros::Time kStart(1603715273, 262142977);

class StereoBagTest : public testing::Test {
 protected:
  StereoBagTest() {
    rig.calibration.size_px = {8, 6};
    rig.calibration.fx_px = rig.calibration.fy_px = 10.0;
    rig.calibration.cx_px = 4.0;
    rig.calibration.cy_px = 3.0;
    rig.calibration.cx_right_px = 5.5;
    rig.calibration.baseline_m = 0.12;
    rig.T_B_C = opticalFromForward().inverse();
    rig.T_B_C.translation() = Eigen::Vector3d(0.1, 0.06, 0.02);
    rig.T_B_L.translation() = Eigen::Vector3d(0.12, 0.0, -0.05);
  }

  std::string path() const { return folder.path("flight.bag"); }

  /// Two pairs 0.1 s apart, an imu reading and a range between them, poses around them.
  void writeFlight() const {
    StereoBagWriter bag(path(), rig, kStart);
    Eigen::Isometry3d T_W_B = Eigen::Isometry3d::Identity();
    bag.writePose(kStart, T_W_B);
    T_W_B.translation().x() = 1.0;
    bag.writePose(kStart + ros::Duration(0.2), T_W_B);
    bag.writePair(kStart + ros::Duration(0.1), cv::Mat(6, 8, CV_8UC3, {1, 2, 3}), cv::Mat(6, 8, CV_8UC3, {4, 5, 6}));
    bag.writePair(kStart, cv::Mat(6, 8, CV_8UC1, 10), cv::Mat(6, 8, CV_8UC1, 20));
    bag.writeImu(kStart + ros::Duration(0.03), {0.5, 0.0, 9.75});
    RangeReading reading;
    reading.range_m = -kInfinity;
    reading.max_range_m = 100.0;
    bag.writeRange(kStart + ros::Duration(0.05), reading);
    bag.close();
  }

  /// Makes the length that stands before the last such text in the bag absurd.
  void damageLast(const std::string& text) const {
    std::fstream file(path(), std::ios::in | std::ios::out | std::ios::binary);
    const std::string content{std::istreambuf_iterator<char>(file), {}};
    file.seekp(static_cast<std::streamoff>(content.rfind(text) - 4));
    file.write("\xff\xff\xff\xff", 4);
  }

  std::string playError() const {
    const StereoBagReader bag(path(), {});
    try {
      bag.play({}, {[](const StereoMessages&) {}, [](const sensor_msgs::RangeConstPtr&) {},
                    [](const sensor_msgs::ImuConstPtr&) {}});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  std::string readError(const StereoTopics& topics) const {
    try {
      StereoBagReader(path(), topics);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  test_support::TemporaryFolder folder;
  BagRig rig;
};

TEST_F(StereoBagTest, HandsOutWhatWasWrittenInTheOrderOfRecording) {
  writeFlight();
  const StereoBagReader bag(path(), {});
  std::vector<ros::Time> stamps;
  std::vector<StereoMessages> pairs;
  bag.play({}, {[&](const StereoMessages& pair) {
                  stamps.push_back(pair.left->header.stamp);
                  pairs.push_back(pair);
                },
                [&](const sensor_msgs::RangeConstPtr& range) {
                  stamps.push_back(range->header.stamp);
                  EXPECT_EQ(range->range, -std::numeric_limits<float>::infinity());
                },
                [&](const sensor_msgs::ImuConstPtr& imu) {
                  stamps.push_back(imu->header.stamp);
                  EXPECT_EQ(imu->header.frame_id, "base_link");
                  EXPECT_EQ(imu->linear_acceleration.x, 0.5);
                  EXPECT_EQ(imu->linear_acceleration.z, 9.75);
                  EXPECT_EQ(imu->angular_velocity_covariance[0], -1.0);
                  EXPECT_EQ(imu->linear_acceleration_covariance[0], 0.0);
                }});
  EXPECT_EQ(stamps, (std::vector<ros::Time>{kStart, kStart + ros::Duration(0.03), kStart + ros::Duration(0.05),
                                            kStart + ros::Duration(0.1)}));
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].right->data.front(), 20);
  EXPECT_EQ(pairs[1].left->encoding, sensor_msgs::image_encodings::BGR8);
  EXPECT_EQ(bag.leftImages(), 2u);
  EXPECT_NEAR(bag.rate(), 10.0, 1e-6);
  EXPECT_TRUE(bag.hasRanges());
}

TEST_F(StereoBagTest, CalibrationSurvivesAlsoWithPrincipalPointsThatDiffer) {
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

TEST_F(StereoBagTest, TransformsAreInterpolatedBetweenPoses) {
  writeFlight();
  const StereoBagReader bag(path(), {});
  const auto T_W_C = bag.transforms().find("odom", "stereo_left_optical", kStart + ros::Duration(0.1));
  Eigen::Isometry3d expected = rig.T_B_C;
  expected.translation().x() += 0.5;
  ASSERT_TRUE(T_W_C);
  EXPECT_TRUE(T_W_C->isApprox(expected, 1e-6));
}

TEST_F(StereoBagTest, StaticTransformsAreLatched) {
  writeFlight();
  rosbag::Bag bag(path(), rosbag::bagmode::Read);
  rosbag::View view(bag, rosbag::TopicQuery("/tf_static"));
  ASSERT_EQ(view.size(), 1u);
  EXPECT_EQ(view.getConnections().front()->header->at("latching"), "1");
}

TEST_F(StereoBagTest, PairsImagesOfSimilarStampsWhenAsked) {
  {
    rosbag::Bag bag(path(), rosbag::bagmode::Write);
    const StereoTopics topics;
    for (int i = 0; i < 5; ++i) {
      const ros::Time stamp = kStart + ros::Duration(0.1 * i), late = stamp + ros::Duration(0.004);
      sensor_msgs::Image image;
      sensor_msgs::CameraInfo info;
      image.header.stamp = info.header.stamp = stamp;
      bag.write(topics.left, stamp, image);
      bag.write(topics.left_info, stamp, info);
      image.header.stamp = info.header.stamp = late;
      bag.write(topics.right, late, image);
      bag.write(topics.right_info, late, info);
    }
    bag.close();
  }
  const StereoBagReader bag(path(), {});
  const auto count = [&](const flight_corridor_ros::RosConfig& pairing) {
    int pairs = 0;
    bag.play(pairing, {[&](const StereoMessages& pair) {
                         ++pairs;
                         EXPECT_NEAR((pair.right->header.stamp - pair.left->header.stamp).toSec(), 0.004, 1e-9);
                       },
                       nullptr, nullptr});
    return pairs;
  };
  flight_corridor_ros::RosConfig pairing;
  EXPECT_EQ(count(pairing), 0);
  pairing.approximate_sync = true;
  pairing.sync_slop_s = 0.001;
  EXPECT_EQ(count(pairing), 0);
  pairing.sync_slop_s = 0.01;
  EXPECT_GE(count(pairing), 4);  // the policy may wait for one more before it lets the last one go
}

TEST_F(StereoBagTest, NamesAMissingBag) { EXPECT_EQ(readError({}), path() + ": cannot be read"); }

TEST_F(StereoBagTest, NamesAFileThatIsNoBag) {
  for (const char* text : {"", "#ROS", "stamp,state\n"}) {
    std::ofstream(path()) << text;
    EXPECT_EQ(readError({}), path() + ": cannot be read: is no bag");
  }
}

TEST_F(StereoBagTest, NamesABagThatWasCutOffAndItsRemedy) {
  writeFlight();
  for (const std::uintmax_t size : {20u, 5000u}) {
    fs::resize_file(path(), size);
    const std::string error = readError({});
    EXPECT_EQ(error.find(path() + ": cannot be read: "), 0u) << error;
    EXPECT_NE(error.find("rosbag reindex " + path()), std::string::npos) << error;
  }
}

TEST_F(StereoBagTest, NamesTheTopicOfADamagedMessage) {
  writeFlight();
  damageLast("range_link");  // of the range, which was written last
  EXPECT_EQ(playError().find(path() + ": cannot be read: topic /range: "), 0u) << playError();
}

TEST_F(StereoBagTest, NamesATopicThatHoldsTwoTypes) {
  writeFlight();
  rosbag::Bag bag(path(), rosbag::bagmode::Append);
  bag.write("/tf", kStart, sensor_msgs::CameraInfo());
  bag.close();
  EXPECT_EQ(readError({}), path() + ": topic /tf holds sensor_msgs/CameraInfo besides tf2_msgs/TFMessage");
}

TEST_F(StereoBagTest, NamesAMissingTopicAndThoseThatAreThere) {
  writeFlight();
  StereoTopics topics;
  topics.right = "/cam1/image";
  const std::string error = readError(topics);
  EXPECT_NE(error.find(": no topic /cam1/image of type sensor_msgs/Image"), std::string::npos) << error;
  EXPECT_NE(error.find("/stereo/right/image_rect sensor_msgs/Image"), std::string::npos) << error;
}

TEST_F(StereoBagTest, NamesATopicOfAnotherType) {
  writeFlight();
  StereoTopics topics;
  topics.left = "/range";
  EXPECT_NE(readError(topics).find("no topic /range of type sensor_msgs/Image"), std::string::npos);
}

TEST_F(StereoBagTest, TheImuMayBeMissingUnlessItIsRequired) {
  writeFlight();
  EXPECT_NO_THROW(StereoBagReader(path(), {}).requireImu());
  StereoTopics topics;
  topics.imu = "/mavros/imu/data";
  EXPECT_EQ(readError(topics), "");
  EXPECT_THROW(StereoBagReader(path(), topics).requireImu(), std::runtime_error);
  topics.imu = "/range";
  EXPECT_NE(readError(topics).find("no topic /range of type sensor_msgs/Imu"), std::string::npos);
}

TEST_F(StereoBagTest, NamesAFileThatCannotBeWritten) {
  EXPECT_THROW(StereoBagWriter("/no/such/folder/a.bag", rig, kStart), std::runtime_error);
}

}  // namespace
}  // namespace flight_corridor::tools
