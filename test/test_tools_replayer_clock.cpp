#include <gtest/gtest.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "support/rewrite_bag.hpp"
#include "support/wall_bag.hpp"
#include "tools/replayer.hpp"

namespace flight_corridor::tools {
namespace {

using test_support::copyMessage;
using test_support::rewriteBag;

/// What the time of recording has to do with verdicts, and how images are packed has not.
class ReplayerClockTest : public test_support::WallBagTest {
 protected:
  /// Records the messages of a topic later than they were; "": of all topics.
  void delay(const std::string& topic, double by_s) const {
    rewriteBag(path(), [&](const rosbag::MessageInstance& message, rosbag::Bag& out) {
      if (!topic.empty() && message.getTopic() != topic) return copyMessage(message, out);
      out.write(message.getTopic(), message.getTime() + ros::Duration(by_s), message, message.getConnectionHeader());
    });
  }

  void expectNoData(const std::vector<Report>& reports) const {
    ASSERT_EQ(reports.size(), 6u);
    for (const Report& report : reports) {
      EXPECT_EQ(report.verdict.state, State::Unknown);
      EXPECT_EQ(report.verdict.reasons, kNoData);
      EXPECT_TRUE(std::isnan(report.verdict.clear_distance_m));
    }
  }
};

TEST_F(ReplayerClockTest, RefusesPairsThatCameLaterThanTheNodeTakes) {
  writeWall(6);
  delay(StereoTopics().right, config.core.corridor.max_age_s + 0.01);
  expectNoData(replay());
}

TEST_F(ReplayerClockTest, RefusesPairsFromTheFuture) {
  writeWall(6);
  delay("", -config.core.corridor.max_age_s - 0.01);
  expectNoData(replay());
}

TEST_F(ReplayerClockTest, RefusesABagWhoseTimesOfRecordingAreThoseOfItsConversion) {
  writeWall(6);
  delay("", 1e8);
  expectNoData(replay());
}

TEST_F(ReplayerClockTest, ByItsStampsAConvertedBagGivesTheVerdictsOfTheRecordedOne) {
  writeWall(6);
  const std::vector<Report> recorded = replay();
  BagReading by_stamps;
  by_stamps.by_stamps = true;
  const auto expectSame = [&](const std::vector<Report>& read, const std::string& how) {
    ASSERT_EQ(read.size(), recorded.size()) << how;
    for (std::size_t i = 0; i < read.size(); ++i) {
      EXPECT_EQ(read[i].verdict.state, recorded[i].verdict.state) << how;
      EXPECT_EQ(read[i].verdict.reasons, recorded[i].verdict.reasons) << how;
      EXPECT_EQ(read[i].range.range_m, recorded[i].range.range_m) << how;
      EXPECT_EQ(read[i].range_lidar_m, recorded[i].range_lidar_m) << how;
    }
  };
  const auto recordAt = [&](const std::function<ros::Time(const rosbag::MessageInstance&)>& time) {
    rewriteBag(path(), [&](const rosbag::MessageInstance& message, rosbag::Bag& out) {
      out.write(message.getTopic(), time(message), message, message.getConnectionHeader());
    });
  };
  expectSame(replay(by_stamps), "as it was recorded");
  recordAt([](const auto&) { return ros::Time(1700000000, 0); });
  expectSame(replay(by_stamps), "all at once");
  EXPECT_NEAR(StereoBagReader(path(), {}, by_stamps).rate(), 10.0, 1e-6);
  recordAt([](const auto&) { return ros::TIME_MIN; });
  expectSame(replay(by_stamps), "at 0");
  double at_s = 1e9;
  recordAt([&](const auto&) { return ros::Time(at_s -= 1.0); });
  expectSame(replay(by_stamps), "backwards");
  const std::vector<std::string> topics{"/tf_static",         StereoTopics().left,       StereoTopics().left_info,
                                        StereoTopics().right, StereoTopics().right_info, StereoTopics().range};
  recordAt([&](const rosbag::MessageInstance& message) {
    const auto place = std::find(topics.begin(), topics.end(), message.getTopic()) - topics.begin();
    return ros::Time(10.0 + static_cast<double>(place));
  });
  expectSame(replay(by_stamps), "topic by topic");
}

TEST_F(ReplayerClockTest, ByItsStampsABagWithPosesIsRead) {
  writeWall(6);
  {
    rosbag::Bag out(path(), rosbag::bagmode::Append);
    for (int i = 0; i < 8; ++i) {
      tf2_msgs::TFMessage poses;
      poses.transforms.resize(1);
      poses.transforms[0].header.frame_id = "odom";
      poses.transforms[0].header.stamp = test_support::kWallStart + ros::Duration(0.1 * i);
      poses.transforms[0].child_frame_id = "base_link";
      poses.transforms[0].transform.rotation.w = 1.0;
      out.write("tf", ros::Time(5.0), poses);
    }
  }
  delay("", 1e7);
  config.core.map.frame_id = "odom";
  BagReading by_stamps;
  by_stamps.by_stamps = true;
  EXPECT_EQ(replay(by_stamps).back().verdict.state, State::Blocked);
}

TEST_F(ReplayerClockTest, TransformsAreReadWithoutALeadingSlash) {
  writeWall(6);
  const std::vector<Report> with = replay();
  rewriteBag(path(), [&](const rosbag::MessageInstance& message, rosbag::Bag& out) {
    if (message.getTopic() != "/tf_static") return copyMessage(message, out);
    out.write("tf_static", message.getTime(), *message.instantiate<tf2_msgs::TFMessage>());
  });
  const std::vector<Report> without = replay();
  ASSERT_EQ(without.size(), with.size());
  EXPECT_EQ(without.back().range_lidar_m, with.back().range_lidar_m);
  EXPECT_TRUE(std::isfinite(without.back().range_lidar_m));
}

TEST_F(ReplayerClockTest, TakesPairsThatCameInTime) {
  writeWall(6);
  for (const double by_s : {0.4, -0.8}) {  // 0.4 s later, then 0.4 s before their stamps
    delay("", by_s);
    const std::vector<Report> reports = replay();
    ASSERT_EQ(reports.size(), 6u);
    EXPECT_EQ(reports.back().verdict.state, State::Blocked) << by_s;
  }
}

TEST_F(ReplayerClockTest, OnlyThePairsThatAreLateAreRefused) {
  writeWall(6);
  int count = 0;
  rewriteBag(path(), [&](const rosbag::MessageInstance& message, rosbag::Bag& out) {
    const bool is_last = message.getTopic() == StereoTopics().left && ++count == 6;
    out.write(message.getTopic(), message.getTime() + ros::Duration(is_last ? 0.6 : 0.0), message);
  });
  std::vector<std::uint32_t> refused;
  std::vector<bool> has_products;
  const StereoBagReader bag(path(), {});
  Replayer(bag, config).run([&](const Answer& answer) {
    refused.push_back(answer.report.verdict.reasons & kNoData);
    has_products.push_back(answer.pipeline != nullptr);
  });
  EXPECT_EQ(refused, (std::vector<std::uint32_t>{0, 0, 0, 0, 0, kNoData}));
  EXPECT_EQ(has_products, (std::vector<bool>{true, true, true, true, true, false}));
}

TEST_F(ReplayerClockTest, TheLimitIsTheNodes) {
  writeWall(6);
  delay("", 0.2);
  config.core.corridor.max_age_s = 0.1;
  expectNoData(replay());
  config.core.corridor.max_age_s = 0.3;
  EXPECT_EQ(replay().back().verdict.state, State::Blocked);
}

TEST_F(ReplayerClockTest, PairsWithoutAStampAreRefused) {
  writeWall(6);
  rewriteBag(path(), [&](const rosbag::MessageInstance& message, rosbag::Bag& out) {
    if (const auto image = message.instantiate<sensor_msgs::Image>()) {
      image->header.stamp = ros::Time();
      return out.write(message.getTopic(), message.getTime(), *image);
    }
    if (const auto info = message.instantiate<sensor_msgs::CameraInfo>()) {
      info->header.stamp = ros::Time();
      return out.write(message.getTopic(), message.getTime(), *info);
    }
    copyMessage(message, out);
  });
  expectNoData(replay());
}

TEST_F(ReplayerClockTest, APoseThatComesTooLateIsMissing) {
  const auto writeWithPoses = [&](double delay_s) {
    writeWall(6);
    StereoBagWriter poses(folder.path("poses.bag"), rig, test_support::kWallStart);
    for (int i = 0; i < 8; ++i) {
      poses.writePose(test_support::kWallStart + ros::Duration(0.1 * i), Eigen::Isometry3d::Identity());
    }
    poses.close();
    rosbag::Bag in(folder.path("poses.bag"), rosbag::bagmode::Read), out(path(), rosbag::bagmode::Append);
    for (const rosbag::MessageInstance& message : rosbag::View(in, rosbag::TopicQuery("/tf"))) {
      out.write("/tf", message.getTime() + ros::Duration(delay_s), message);
    }
  };
  config.core.map.frame_id = "odom";
  config.ros.tf_timeout_s = 0.05;
  writeWithPoses(0.04);
  EXPECT_EQ(replay().back().verdict.state, State::Blocked);
  writeWithPoses(0.06);
  for (const Report& report : replay()) {
    EXPECT_EQ(report.verdict.state, State::Unknown);
    EXPECT_TRUE(report.verdict.reasons & kNoPose);
  }
}

TEST_F(ReplayerClockTest, CompressedImagesGiveTheSameVerdicts) {
  const StereoTopics topics;
  writeWall(6);
  const std::vector<Report> raw = replay();
  for (const std::string& topic : {topics.left, topics.right}) {
    test_support::compressTopic(path(), topic, ".png", topic + "/compressed");
    const std::vector<Report> read = replay();
    ASSERT_EQ(read.size(), raw.size());
    for (std::size_t i = 0; i < raw.size(); ++i) {
      EXPECT_EQ(read[i].verdict.reasons, raw[i].verdict.reasons);
      EXPECT_EQ(read[i].verdict.clear_distance_m, raw[i].verdict.clear_distance_m);
      EXPECT_EQ(read[i].range.range_m, raw[i].range.range_m);
    }
  }
}

TEST_F(ReplayerClockTest, ADamagedImageIsABadOneAndTheNextPairIsAnswered) {
  const StereoTopics topics;
  writeWall(6);
  int count = 0;
  rewriteBag(path(), [&](const rosbag::MessageInstance& message, rosbag::Bag& out) {
    if (message.getTopic() != topics.left) return copyMessage(message, out);
    auto compressed = test_support::compress(message.instantiate<sensor_msgs::Image>(), ".jpg");
    if (++count == 4) compressed.data.resize(compressed.data.size() / 2);
    out.write(topics.left + "/compressed", message.getTime(), compressed);
  });
  const std::vector<Report> reports = replay();
  ASSERT_EQ(reports.size(), 6u);
  for (std::size_t i = 0; i < reports.size(); ++i) {
    EXPECT_EQ((reports[i].verdict.reasons & kBadImage) != 0, i == 3) << i;
  }
  EXPECT_EQ(reports.back().verdict.state, State::Blocked);
}

}  // namespace
}  // namespace flight_corridor::tools
