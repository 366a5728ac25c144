#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <sensor_msgs/image_encodings.h>

#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "ros/conversions.hpp"
#include "ros/transforms.hpp"
#include "support/rewrite_bag.hpp"
#include "support/small_flight.hpp"
#include "tools/stereo_bag_reader.hpp"

namespace flight_corridor::tools {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;
using test_support::compressTopic;
using test_support::copyMessage;
using test_support::kStart;
using test_support::rewriteBag;

class StereoBagReaderTest : public test_support::SmallFlightTest {
 protected:
  /// Makes the length that stands before the last such text in the bag absurd.
  void damageLast(const std::string& text) const {
    std::fstream file(path(), std::ios::in | std::ios::out | std::ios::binary);
    const std::string content{std::istreambuf_iterator<char>(file), {}};
    file.seekp(static_cast<std::streamoff>(content.rfind(text) - 4));
    file.write("\xff\xff\xff\xff", 4);
  }

  std::string playError(const BagReading& reading = {}) const {
    const StereoBagReader bag(path(), {}, reading);
    try {
      bag.play({}, ignoringAll());
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

  static StereoBagReader::Listener ignoringAll() {
    return {[](const RecordedPair&) {}, [](const sensor_msgs::RangeConstPtr&) {}};
  }

  std::vector<StereoMessages> pairs(const StereoTopics& topics) const {
    std::vector<StereoMessages> pairs;
    StereoBagReader::Listener listener = ignoringAll();
    listener.on_pair = [&](const RecordedPair& pair) { pairs.push_back(pair); };
    StereoBagReader(path(), topics).play({}, listener);
    return pairs;
  }
};

TEST_F(StereoBagReaderTest, HandsOutWhatWasWrittenInTheOrderOfRecording) {
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

TEST_F(StereoBagReaderTest, HandsOutTransformsAsEarlyAsTheNodeWaitsForThem) {
  writeFlight();  // poses of 0 and 0.2 s, pairs of 0 and 0.1 s, recorded 0.001 s later
  const StereoBagReader bag(path(), {});
  const auto findPoses = [&](double tf_timeout_s) {
    flight_corridor_ros::RosConfig config;
    config.tf_timeout_s = tf_timeout_s;
    flight_corridor_ros::Transforms transforms;
    std::vector<std::optional<Eigen::Isometry3d>> poses;
    StereoBagReader::Listener listener = ignoringAll();
    listener.on_transform = [&](const auto& transform, bool is_static) { transforms.add(transform, is_static); };
    listener.on_pair = [&](const RecordedPair& pair) {
      poses.push_back(transforms.find("odom", "stereo_left_optical", pair.header.stamp));
    };
    bag.play(config, listener);
    return poses;
  };
  const auto early = findPoses(0.098), late = findPoses(0.1);
  ASSERT_EQ(early.size(), 2u);
  EXPECT_TRUE(early[0]);
  EXPECT_FALSE(early[1]) << "the later pose comes 0.099 s after the pair";
  Eigen::Isometry3d expected = rig.T_B_C;
  expected.translation().x() += 0.5;
  ASSERT_TRUE(late[1]);
  EXPECT_TRUE(late[1]->isApprox(expected, 1e-6));
}

TEST_F(StereoBagReaderTest, TellsWhenTheLastMessageOfAPairWasRecorded) {
  writeFlight();
  const ros::Duration delay(0.4);
  rewriteBag(path(), [&](const rosbag::MessageInstance& message, rosbag::Bag& out) {
    if (message.getTopic() != StereoTopics().right_info) return copyMessage(message, out);
    out.write(message.getTopic(), message.getTime() + delay, message);
  });
  std::vector<double> ages_s;
  StereoBagReader::Listener listener = ignoringAll();
  listener.on_pair = [&](const RecordedPair& pair) { ages_s.push_back((pair.recorded - pair.header.stamp).toSec()); };
  StereoBagReader(path(), {}).play({}, listener);
  ASSERT_EQ(ages_s.size(), 2u);
  for (const double age_s : ages_s) EXPECT_NEAR(age_s, 0.401, 1e-6);
}

TEST_F(StereoBagReaderTest, ReadsCompressedImagesAsTheRawOnes) {
  const StereoTopics topics;
  writeFlight();
  const std::vector<StereoMessages> raw = pairs(topics);
  compressTopic(path(), topics.left, ".png", topics.left + "/compressed");
  const std::vector<StereoMessages> mixed = pairs(topics);  // only the left ones
  compressTopic(path(), topics.right, ".png", topics.right + "/compressed");
  for (const std::vector<StereoMessages>& read : {mixed, pairs(topics)}) {
    ASSERT_EQ(read.size(), raw.size());
    for (std::size_t i = 0; i < raw.size(); ++i) {
      EXPECT_EQ(*read[i].left, *raw[i].left);
      EXPECT_EQ(*read[i].right, *raw[i].right);
      EXPECT_EQ(*read[i].right_info, *raw[i].right_info);
    }
  }
  EXPECT_EQ(StereoBagReader(path(), topics).leftImages(), 2u);
  EXPECT_NEAR(StereoBagReader(path(), topics).rate(), 10.0, 1e-6);
}

TEST_F(StereoBagReaderTest, ReadsCompressedImagesUnderTheGivenName) {
  StereoTopics topics;
  writeFlight();
  compressTopic(path(), topics.left, ".jpg", "/cam0/jpeg");
  compressTopic(path(), topics.right, ".jpg", "/cam1/jpeg/compressed");
  topics.left = "/cam0/jpeg";
  topics.right = "/cam1/jpeg/compressed";
  ASSERT_EQ(pairs(topics).size(), 2u);
  EXPECT_NEAR(pairs(topics)[0].right->data.front(), 20, 2);  // an even image survives JPEG
}

TEST_F(StereoBagReaderTest, TakesRawImagesWhereBothAreThere) {
  const StereoTopics topics;
  writeFlight();
  rewriteBag(path(), [&](const rosbag::MessageInstance& message, rosbag::Bag& out) {
    copyMessage(message, out);
    if (message.getTopic() != topics.left) return;
    sensor_msgs::CompressedImage damaged;
    damaged.header = message.instantiate<Image>()->header;
    for (int i = 0; i < 3; ++i) out.write(topics.left + "/compressed", message.getTime(), damaged);
  });
  EXPECT_EQ(StereoBagReader(path(), topics).leftImages(), 2u);
  for (const StereoMessages& pair : pairs(topics)) EXPECT_FALSE(pair.left->data.empty());
}

TEST_F(StereoBagReaderTest, HandsOutAnEmptyImageForADamagedOne) {
  const StereoTopics topics;
  writeFlight();
  bool is_first = true;
  rewriteBag(path(), [&](const rosbag::MessageInstance& message, rosbag::Bag& out) {
    if (message.getTopic() != topics.right) return copyMessage(message, out);
    auto compressed = test_support::compress(message.instantiate<Image>(), ".png");
    if (std::exchange(is_first, false)) compressed.data.resize(compressed.data.size() / 2);
    out.write(topics.right + "/compressed", message.getTime(), compressed);
  });
  const std::vector<StereoMessages> read = pairs(topics);
  ASSERT_EQ(read.size(), 2u);
  EXPECT_TRUE(read[0].right->data.empty());
  EXPECT_EQ(read[0].right->width, 0u);
  EXPECT_FALSE(read[0].left->data.empty());
  EXPECT_FALSE(read[1].right->data.empty());
}

TEST_F(StereoBagReaderTest, TellsTheStampsOfAllThatMightBecomePairs) {
  const StereoTopics topics;
  writeFlight();
  rewriteBag(path(), [&](const rosbag::MessageInstance& message, rosbag::Bag& out) {
    if (message.getTopic() != topics.left_info) return copyMessage(message, out);
    out.write(message.getTopic(), message.getTime(), CameraInfo());
  });
  const PairStamps heard = StereoBagReader(path(), topics).play({}, ignoringAll());
  EXPECT_EQ(heard[0].topic, topics.left);
  EXPECT_EQ(heard[0].stamps, (std::vector<ros::Time>{kStart, kStart + ros::Duration(0.1)}));
  EXPECT_EQ(heard[1].topic, topics.left_info);
  EXPECT_EQ(heard[1].stamps, (std::vector<ros::Time>{ros::Time(), ros::Time()}));
  EXPECT_EQ(heard[3].stamps, heard[0].stamps);
}

TEST_F(StereoBagReaderTest, PairsImagesOfSimilarStampsWhenAsked) {
  {
    rosbag::Bag bag(path(), rosbag::bagmode::Write);  // closes itself
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

TEST_F(StereoBagReaderTest, NamesTheTopicOfADamagedMessage) {
  writeFlight();
  damageLast("range_link");  // of the range, which was written last
  BagReading by_stamps;
  by_stamps.by_stamps = true;
  for (const std::string& error : {playError(), playError(by_stamps)}) {
    EXPECT_EQ(error.find(path() + ": cannot be read: topic /range: "), 0u) << error;
  }
}

TEST_F(StereoBagReaderTest, NamesATopicThatHoldsTwoTypes) {
  writeFlight();
  rosbag::Bag bag(path(), rosbag::bagmode::Append);
  bag.write("/tf", kStart, sensor_msgs::CameraInfo());
  bag.close();
  EXPECT_EQ(readError({}), path() + ": topic /tf holds sensor_msgs/CameraInfo besides tf2_msgs/TFMessage");
}

TEST_F(StereoBagReaderTest, NamesAMissingTopicAndThoseThatAreThere) {
  writeFlight();
  StereoTopics topics;
  topics.right = "/cam1/image";
  const std::string error = readError(topics);
  EXPECT_NE(error.find(": no topic /cam1/image of type sensor_msgs/Image, nor /cam1/image/compressed of type "
                       "sensor_msgs/CompressedImage; it has"),
            std::string::npos)
      << error;
  EXPECT_NE(error.find("/stereo/right/image_rect sensor_msgs/Image"), std::string::npos) << error;
}

TEST_F(StereoBagReaderTest, NamesATopicOfAnotherType) {
  writeFlight();
  StereoTopics topics;
  topics.left = "/range";  // nor is /range/compressed there
  EXPECT_NE(readError(topics).find("no topic /range of type sensor_msgs/Image"), std::string::npos);
}

TEST_F(StereoBagReaderTest, TheImuMayBeMissingUnlessItIsRequired) {
  writeFlight();
  EXPECT_NO_THROW(StereoBagReader(path(), {}).requireImu());
  StereoTopics topics;
  topics.imu = "/mavros/imu/data";
  EXPECT_EQ(readError(topics), "");
  EXPECT_THROW(StereoBagReader(path(), topics).requireImu(), std::runtime_error);
  topics.imu = "/range";
  EXPECT_NE(readError(topics).find("no topic /range of type sensor_msgs/Imu"), std::string::npos);
}

}  // namespace
}  // namespace flight_corridor::tools
