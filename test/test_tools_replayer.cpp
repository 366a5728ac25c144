#include <gtest/gtest.h>
#include <tf2_eigen/tf2_eigen.h>
#include <tf2_msgs/TFMessage.h>

#include <array>
#include <cmath>
#include <map>
#include <memory>

#include "ros/conversions.hpp"
#include "support/wall_bag.hpp"
#include "tools/command_line.hpp"
#include "tools/csv.hpp"
#include "tools/map_file.hpp"
#include "tools/replayer.hpp"

namespace flight_corridor::tools {
namespace {

using test_support::kBaseline_m, test_support::kFocal_px, test_support::kHeight, test_support::kWallStart,
    test_support::kWidth;

class ReplayerTest : public test_support::WallBagTest {
 protected:
  /// Adds half a second of an imu, and of its attitude where wanted: level.
  void writeImu(const sensor_msgs::Imu& imu, bool with_attitude = true) const {
    rosbag::Bag bag(path(), rosbag::bagmode::Append);
    for (int i = 0; i <= 50; ++i) {
      const ros::Time stamp = kWallStart + ros::Duration(0.01 * i);
      sensor_msgs::Imu stamped = imu;
      stamped.header.stamp = stamp;
      stamped.header.frame_id = "base_link";
      bag.write(StereoTopics().imu, stamp, stamped);
      geometry_msgs::TransformStamped level = tf2::eigenToTransform(Eigen::Isometry3d::Identity());
      level.header.stamp = stamp;
      level.header.frame_id = "odom";
      level.child_frame_id = "base_link";
      tf2_msgs::TFMessage transforms;
      transforms.transforms = {level};
      if (with_attitude) bag.write("/tf", stamp, transforms);
    }
    bag.close();
  }

  static sensor_msgs::Imu imu(double forward_mps2) {
    sensor_msgs::Imu message;
    message.linear_acceleration.x = forward_mps2;
    message.linear_acceleration.z = 9.80665;
    return message;
  }

  void writeOne(const sensor_msgs::Image& left, const sensor_msgs::Image& right) const {
    writeWall(6);
    rosbag::Bag bag(path(), rosbag::bagmode::Append);
    const ros::Time stamp = kWallStart + ros::Duration(10.0);
    const StereoTopics topics;
    sensor_msgs::CameraInfo info = cameraInfo();
    info.header.stamp = stamp;
    bag.write(topics.left_info, stamp, info);
    info.P[3] = -kFocal_px * kBaseline_m;
    bag.write(topics.right_info, stamp, info);
    for (const auto& [topic, image] : {std::pair{topics.left, left}, std::pair{topics.right, right}}) {
      sensor_msgs::Image stamped = image;
      stamped.header.stamp = stamp;
      stamped.header.frame_id = info.header.frame_id;
      bag.write(topic, stamp, stamped);
    }
    bag.close();
  }

  sensor_msgs::CameraInfo cameraInfo() const {
    sensor_msgs::CameraInfo info;
    info.header.frame_id = "stereo_left_optical";
    info.width = kWidth;
    info.height = kHeight;
    info.P = {kFocal_px, 0, 79.5, 0, 0, kFocal_px, 59.5, 0, 0, 0, 1, 0};
    return info;
  }

  static sensor_msgs::Image image(int width, int height, const std::string& encoding) {
    sensor_msgs::Image message;
    message.width = static_cast<std::uint32_t>(width);
    message.height = static_cast<std::uint32_t>(height);
    message.encoding = encoding;
    message.step = message.width;
    message.data.resize(message.width * message.height, 100);
    return message;
  }
};

TEST_F(ReplayerTest, ReportsTheWallThatStereoAndLidarSee) {
  writeWall(6);  // 90 px * 0.12 m / 6 px = 1.8 m
  const std::vector<Report> reports = replay();
  ASSERT_EQ(reports.size(), 6u);
  const Report& last = reports.back();
  EXPECT_EQ(last.verdict.state, State::Blocked);
  // A sixteenth of a pixel, the matcher's step, is 1.8^2 / (90 * 0.12) / 16 = 0.019 m; the LiDAR's float adds nothing.
  EXPECT_NEAR(last.range_stereo_m, 1.8, 0.02);
  EXPECT_NEAR(last.range_lidar_m, 1.8, 1e-6);
  EXPECT_NEAR(last.range.range_m, 1.8, 0.02);
}

TEST_F(ReplayerTest, GivesTheSameAnswersTwice) {
  writeWall(6);
  const std::vector<Report> once = replay(), again = replay();
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_EQ(once[i].verdict.state, again[i].verdict.state);
    EXPECT_EQ(once[i].verdict.clear_distance_m, again[i].verdict.clear_distance_m);
    EXPECT_EQ(once[i].verdict.unknown_fraction, again[i].verdict.unknown_fraction);
    EXPECT_EQ(once[i].verdict.reasons, again[i].verdict.reasons);
    EXPECT_EQ(once[i].range.range_m, again[i].range.range_m);
    EXPECT_EQ(once[i].scale, again[i].scale);
  }
}

TEST_F(ReplayerTest, OdometryTellsTheMotionWhereNeitherTfNorTheImagesDo) {
  writeOne(image(kWidth, kHeight, "mono8"), image(kWidth, kHeight, "mono8"));  // the last pair is plain
  EXPECT_TRUE(replay().back().verdict.reasons & kNoMotion);
  rosbag::Bag bag(path(), rosbag::bagmode::Append);
  for (int i = 0; i < 2; ++i) {
    nav_msgs::Odometry odometry;
    odometry.header.stamp = kWallStart + ros::Duration(9.9 + 0.1 * i);
    odometry.child_frame_id = "base_link";
    odometry.pose.pose.orientation.w = 1.0;
    bag.write(StereoTopics().odom, odometry.header.stamp, odometry);
  }
  bag.close();
  EXPECT_FALSE(replay().back().verdict.reasons & kNoMotion);
}

TEST_F(ReplayerTest, AnImuAtRestChangesNothing) {
  writeWall(6);
  const Report without = replay().back();
  writeImu(imu(0.0));
  const Report with = replay().back();
  EXPECT_EQ(with.verdict.state, without.verdict.state);
  EXPECT_NEAR(with.range.range_m, without.range.range_m, 1e-6);
  EXPECT_NEAR(with.range.rate_mps, without.range.rate_mps, 1e-6);
}

TEST_F(ReplayerTest, TheImusForwardAccelerationShortensThePredictedRange) {
  writeWall(6);
  const Report without = replay().back();
  writeImu(imu(1.0));
  const Report with = replay().back();
  EXPECT_LT(with.range.rate_mps, without.range.rate_mps - 1e-3);
  EXPECT_EQ(with.verdict.state, without.verdict.state);
}

TEST_F(ReplayerTest, AnImuThatCannotBeUsedDoesNoHarm) {
  sensor_msgs::Imu nan = imu(std::nan("")), infinite = imu(kInfinity), none = imu(5.0);
  none.linear_acceleration_covariance[0] = -1.0;
  writeWall(6);
  const Report without = replay().back();
  for (const auto& [unusable, with_attitude] :
       {std::pair{nan, true}, std::pair{infinite, true}, std::pair{none, true}, std::pair{imu(5.0), false}}) {
    writeWall(6);
    writeImu(unusable, with_attitude);
    const Report with = replay().back();
    EXPECT_EQ(with.verdict.state, without.verdict.state);
    EXPECT_EQ(with.verdict.reasons, without.verdict.reasons);
    EXPECT_EQ(with.range.range_m, without.range.range_m);
    EXPECT_EQ(with.range.rate_mps, without.range.rate_mps);
  }
}

TEST_F(ReplayerTest, AnswersBadImageForImagesOfAnotherSize) {
  writeOne(image(kWidth, kHeight, "mono8"), image(kWidth / 2, kHeight, "mono8"));
  const Report report = replay().back();
  EXPECT_EQ(report.verdict.state, State::Unknown);
  EXPECT_TRUE(report.verdict.reasons & kBadImage);
}

TEST_F(ReplayerTest, AnswersBadImageForEmptyImages) {
  writeOne(image(0, 0, "mono8"), image(0, 0, "mono8"));
  const Report report = replay().back();
  EXPECT_EQ(report.verdict.state, State::Unknown);
  EXPECT_TRUE(report.verdict.reasons & kBadImage);
}

TEST_F(ReplayerTest, AnswersBadImageForAnUnknownEncoding) {
  writeOne(image(kWidth, kHeight, "purple7"), image(kWidth, kHeight, "mono8"));
  const Report report = replay().back();
  EXPECT_EQ(report.verdict.state, State::Unknown);
  EXPECT_TRUE(report.verdict.reasons & kBadImage);
}

TEST_F(ReplayerTest, AnswersBadCalibrationForAZeroBaseline) {
  rig.calibration.baseline_m = 0.0;
  writeWall(6);
  const std::vector<Report> reports = replay();
  ASSERT_EQ(reports.size(), 6u);
  for (const Report& report : reports) {
    EXPECT_EQ(report.verdict.state, State::Unknown);
    EXPECT_EQ(report.verdict.reasons, kBadCalibration);
    EXPECT_TRUE(std::isnan(report.verdict.clear_distance_m));
  }
}

TEST_F(ReplayerTest, AnswersNoPoseWhenTheMapsFrameIsNotInTheBag) {
  writeWall(6);
  config.core.map.frame_id = "odom";
  for (const Report& report : replay()) {
    EXPECT_EQ(report.verdict.state, State::Unknown);
    EXPECT_TRUE(report.verdict.reasons & kNoPose);
  }
}

TEST_F(ReplayerTest, RefusedPairsHaveNoProducts) {
  writeOne(image(0, 0, "mono8"), image(0, 0, "mono8"));
  const StereoBagReader bag(path(), {});
  std::vector<bool> has_products;
  Replayer(bag, config).run([&](const Answer& answer) { has_products.push_back(answer.pipeline != nullptr); });
  EXPECT_EQ(has_products, (std::vector<bool>{true, true, true, true, true, true, false}));
}

/// Each leaf's key, depth and whether it is occupied.
using Leaves = std::map<std::array<unsigned, 4>, bool>;

Leaves leaves(const octomap::OcTree& tree) {
  Leaves all;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const octomap::OcTreeKey key = leaf.getKey();
    all[{key[0], key[1], key[2], leaf.getDepth()}] = tree.isNodeOccupied(*leaf);
  }
  return all;
}

TEST_F(ReplayerTest, TheLastMapCanBeSavedAndReadBackCellByCell) {
  writeWall(6);
  const StereoBagReader bag(path(), {});
  Replayer replayer(bag, config);
  EXPECT_EQ(replayer.map().size(), 0u);
  Leaves of_pipeline;
  replayer.run([&](const Answer& answer) { of_pipeline = leaves(answer.pipeline->map().tree()); });
  ASSERT_GT(of_pipeline.size(), 100u);
  writeMap(folder.path("map.ot"), replayer.map());
  writeMap(folder.path("map.bt"), replayer.map());

  const std::unique_ptr<octomap::AbstractOcTree> full(octomap::AbstractOcTree::read(folder.path("map.ot")));
  ASSERT_TRUE(full);
  EXPECT_TRUE(dynamic_cast<octomap::OcTree&>(*full) == replayer.map());  // also the log-odds
  octomap::OcTree binary(1.0);
  ASSERT_TRUE(binary.readBinary(folder.path("map.bt")));
  EXPECT_EQ(leaves(binary), of_pipeline);
}

TEST(ReadConfig, OverridesKeysOneByOne) {
  const auto config = readConfig("", {"corridor/length_m=3.0", "map/frame_id=odom"});
  EXPECT_EQ(config.core.corridor.length_m, 3.0);
  EXPECT_EQ(config.core.map.frame_id, "odom");
}

TEST(ReadConfig, NamesAnUnknownKeyAndAMissingFile) {
  try {
    readConfig("", {"corridor/lenght_m=3.0"});
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("corridor/lenght_m"), std::string::npos) << error.what();
  }
  try {
    readConfig("/no/such.yaml", {});
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("/no/such.yaml"), std::string::npos) << error.what();
  }
}

ReplayInput inputFrom(const std::string& arguments) {
  ReplayInput input;
  CLI::App app;
  addOptions(app, input);
  app.parse("--bag F.bag " + arguments);
  return input;
}

TEST(ReplayInput, LeavesToTheBagWhatTheCommandLineDoesNotSay) {
  const ReplayInput input = inputFrom("");
  EXPECT_EQ(input.topics.left + input.topics.left_info + input.topics.right + input.topics.right_info, "");
  EXPECT_EQ(input.topics.range + input.topics.imu, "");
  EXPECT_EQ(input.reading.images, ImageState::AsNamed);
  EXPECT_FALSE(input.reading.T_F_L);
  EXPECT_FALSE(input.reading.by_stamps);
}

TEST(ReplayInput, TakesTheLidarsPlaceInOneWordAsStaticTransformPublisherTurns) {
  const auto T_F_L = inputFrom("--lidar-at '-0.1 0  0.05 1.5708 0 -0.2'").reading.T_F_L;
  ASSERT_TRUE(T_F_L);
  EXPECT_EQ(T_F_L->translation(), Eigen::Vector3d(-0.1, 0.0, 0.05));
  EXPECT_NEAR((T_F_L->linear() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-4);
  for (const char* text : {"1 2 3", "1 2 3 4 5 6 7", "1 2 3 4 5 nan", "1 2 3 4 5 x", ""}) {
    EXPECT_THROW(inputFrom("--lidar-at '" + std::string(text) + "'"), CLI::ParseError) << text;
  }
}

TEST(ReplayInput, EachCalibrationFileHasItsOwnOption) {
  const BagReading reading = inputFrom("--calib l.yaml --calib=r.yaml --calib-left cam2 --raw").reading;
  EXPECT_EQ(reading.calibration_files, (std::vector<std::string>{"l.yaml", "r.yaml"}));
  EXPECT_EQ(reading.cameras.left, "cam2");
  EXPECT_EQ(reading.images, ImageState::Raw);
  EXPECT_THROW(inputFrom("--calib l.yaml r.yaml"), CLI::ParseError);
}

TEST(ReplayInput, RefusesOptionsThatContradictOrLackEachOther) {
  EXPECT_THROW(inputFrom("--raw --rectified"), CLI::ExcludesError);
  EXPECT_THROW(inputFrom("--calib-right cam0"), CLI::RequiresError);
}

}  // namespace
}  // namespace flight_corridor::tools
