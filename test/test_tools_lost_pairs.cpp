#include <gtest/gtest.h>

#include <string>

#include "tools/lost_pairs.hpp"

namespace flight_corridor::tools {
namespace {

constexpr int kImages = 31;
constexpr double kPeriod_s = 0.1;

class LostPairsTest : public testing::Test {
 protected:
  LostPairsTest() {
    const std::array<const char*, 4> topics{"/left", "/left_info", "/right", "/right_info"};
    for (std::size_t i = 0; i < heard.size(); ++i) heard[i] = {topics[i], stamps(0.0)};
  }

  static std::vector<ros::Time> stamps(double offset_s) {
    std::vector<ros::Time> stamps;
    for (int i = 0; i < kImages; ++i)
      stamps.push_back(ros::Time(1603715273.0 + kPeriod_s * i) + ros::Duration(offset_s));
    return stamps;
  }

  std::string describe(std::size_t pairs) const { return describeLostPairs(pairs, heard, pairing); }
  static bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

  PairStamps heard;
  flight_corridor_ros::RosConfig pairing;
};

TEST_F(LostPairsTest, SaysNothingWhenNoneIsLost) { EXPECT_EQ(describe(kImages), ""); }

TEST_F(LostPairsTest, SaysWhichTopicsHaveNoStamps) {
  heard[1].stamps.assign(kImages, ros::Time());
  heard[3].stamps.assign(kImages, ros::Time());
  for (const bool approximate : {false, true}) {
    pairing.approximate_sync = approximate;
    EXPECT_EQ(describe(0),
              "0 of 31 left images found their right image and both CameraInfos: /left_info: 31 messages, 31 without a "
              "stamp (0); /right_info: 31 messages, 31 without a stamp (0). The driver must stamp them");
  }
}

TEST_F(LostPairsTest, CountsWhatIsWithoutAStampNowAndThen) {
  heard[0].stamps[3] = heard[2].stamps[7] = heard[2].stamps[8] = ros::Time();
  EXPECT_EQ(describe(28),
            "28 of 31 left images found their right image and both CameraInfos: /left: 31 messages, 1 without a stamp "
            "(0); /right: 31 messages, 2 without a stamp (0). The driver must stamp them");
}

TEST_F(LostPairsTest, AdvisesApproximateSyncWhereItHelpsAndIsNotSet) {
  heard[2].stamps = heard[3].stamps = stamps(0.004);
  EXPECT_EQ(
      describe(0),
      "0 of 31 left images found their right image and both CameraInfos: /right: 31 messages, with the stamps of "
      "0 left images, off the others by 0.004 s (median); /right_info: 31 messages, with the stamps of 0 left "
      "images, off the others by 0.004 s (median). --set ros/approximate_sync=true pairs stamps that differ by up "
      "to 0.01 s");
}

TEST_F(LostPairsTest, NeverAdvisesWhatIsSet) {
  pairing.approximate_sync = true;
  for (const double offset_s : {0.004, 0.02, 0.05}) {
    for (const std::size_t pairs : {0, 3, 30}) {
      heard[2].stamps = stamps(offset_s);
      EXPECT_FALSE(holds(describe(pairs), "ros/approximate_sync")) << describe(pairs);
    }
  }
}

TEST_F(LostPairsTest, TakesStampsWithinTheSetSlopAsEqual) {
  pairing.approximate_sync = true;
  heard[2].stamps = heard[3].stamps = stamps(0.004);
  EXPECT_EQ(describe(kImages - 1), "30 of 31 left images found their right image and both CameraInfos");
  EXPECT_TRUE(holds(describe(0), "ros/sync_queue (10)")) << describe(0);
}

TEST_F(LostPairsTest, AdvisesALargerSlopWhereTheSetOneIsTooSmall) {
  heard[2].stamps = heard[3].stamps = stamps(0.02);
  EXPECT_TRUE(holds(describe(0), "--set ros/approximate_sync=true with a ros/sync_slop_s above that (it is 0.01 s)"));
  pairing.approximate_sync = true;
  EXPECT_TRUE(holds(describe(0), ". A ros/sync_slop_s above that (it is 0.01 s) pairs them")) << describe(0);
  pairing.sync_slop_s = 0.015;
  EXPECT_TRUE(holds(describe(0), "(it is 0.015 s)")) << describe(0);
}

TEST_F(LostPairsTest, AdvisesNoSettingForImagesThatAreNotThere) {
  for (std::vector<ros::Time>* lossy : {&heard[2].stamps, &heard[3].stamps}) lossy->resize(kImages - 6);
  const std::string text = describe(kImages - 6);
  EXPECT_TRUE(holds(text, "/right: 25 messages, with the stamps of 25 left images")) << text;
  EXPECT_TRUE(holds(text, "No setting pairs them")) << text;
  EXPECT_FALSE(holds(text, "ros/")) << text;
}

TEST_F(LostPairsTest, AdvisesNoSettingForClocksThatDiffer) {
  heard[2].stamps = heard[3].stamps = stamps(-1.6e9);
  const std::string text = describe(0);
  EXPECT_TRUE(holds(text, "No setting pairs them: they were not recorded, or the cameras' clocks differ")) << text;
}

TEST_F(LostPairsTest, NamesTheQueueWhereStampsAreEqual) {
  EXPECT_TRUE(holds(describe(0), "ros/sync_queue (10)")) << describe(0);
  EXPECT_EQ(describe(kImages - 1), "30 of 31 left images found their right image and both CameraInfos");
  EXPECT_TRUE(holds(describe(kImages - 3), "after a later pair is complete are too late")) << describe(kImages - 3);
}

TEST_F(LostPairsTest, OneImageAloneIsDescribedToo) {
  for (TopicStamps& topic : heard) topic.stamps.resize(1);
  heard[2].stamps.front() += ros::Duration(0.003);
  EXPECT_TRUE(holds(describe(0), "--set ros/approximate_sync=true pairs")) << describe(0);
}

}  // namespace
}  // namespace flight_corridor::tools
