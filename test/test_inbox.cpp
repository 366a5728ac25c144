#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <future>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "ros/inbox.hpp"

namespace flight_corridor_ros {
namespace {

StereoMessages pairAt(double stamp_s) {
  const auto left = boost::make_shared<sensor_msgs::Image>();
  left->header.stamp = ros::Time(stamp_s);
  StereoMessages pair;
  pair.left = left;
  return pair;
}

sensor_msgs::RangeConstPtr rangeAt(double stamp_s) {
  const auto range = boost::make_shared<sensor_msgs::Range>();
  range->header.stamp = ros::Time(stamp_s);
  return range;
}

sensor_msgs::ImuConstPtr imuAt(double stamp_s) {
  const auto imu = boost::make_shared<sensor_msgs::Imu>();
  imu->header.stamp = ros::Time(stamp_s);
  return imu;
}

TEST(Inbox, TheNewestPairWins) {
  Inbox inbox;
  inbox.put(pairAt(1.0));
  inbox.put(pairAt(2.0));
  EXPECT_EQ(inbox.take()->left->header.stamp, ros::Time(2.0));
}

TEST(Inbox, TakingWaitsForAPairOrTheEnd) {
  Inbox inbox;
  auto taken = std::async(std::launch::async, [&inbox] { return inbox.take(); });
  inbox.put(pairAt(1.0));
  EXPECT_TRUE(taken.get());
  taken = std::async(std::launch::async, [&inbox] { return inbox.take(); });
  inbox.close();
  EXPECT_FALSE(taken.get());
}

TEST(Inbox, TheTakerDoesErrandsBeforeItTakesAPair) {
  Inbox inbox;
  inbox.put(pairAt(1.0));
  std::thread::id done_by;
  inbox.put(Inbox::Errand([&done_by] { done_by = std::this_thread::get_id(); }));
  EXPECT_TRUE(inbox.take());
  EXPECT_EQ(done_by, std::this_thread::get_id());
}

TEST(Inbox, ErrandsAreDoneWithoutAPair) {
  Inbox inbox;
  auto taken = std::async(std::launch::async, [&inbox] { return inbox.take(); });
  Inbox::Errand errand([] {});
  std::future<void> done = errand.get_future();
  inbox.put(std::move(errand));
  EXPECT_EQ(done.wait_for(std::chrono::seconds(10)), std::future_status::ready);
  inbox.close();
  EXPECT_FALSE(taken.get());
}

TEST(Inbox, AClosedInboxBreaksThePromiseOfItsErrands) {
  Inbox inbox;
  Inbox::Errand before([] {}), after([] {});
  std::future<void> before_done = before.get_future(), after_done = after.get_future();
  inbox.put(std::move(before));
  inbox.close();
  inbox.put(std::move(after));
  EXPECT_THROW(before_done.get(), std::future_error);
  EXPECT_THROW(after_done.get(), std::future_error);
}

TEST(InTakersThread, WhatWasGivenUpIsNotDoneLater) {
  Inbox inbox;
  bool is_done = false;
  const auto work = [&is_done] { is_done = true; };
  EXPECT_THROW(inTakersThread(inbox, work, std::chrono::milliseconds(10)), std::runtime_error);
  inbox.put(pairAt(1.0));
  EXPECT_TRUE(inbox.take());
  EXPECT_FALSE(is_done);
}

TEST(InTakersThread, WhatHasBegunIsWaitedFor) {
  Inbox inbox;
  auto taken = std::async(std::launch::async, [&inbox] { return inbox.take(); });
  const auto work = [] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    return 7;
  };
  EXPECT_EQ(inTakersThread(inbox, work, std::chrono::milliseconds(100)), 7);
  inbox.close();
  EXPECT_FALSE(taken.get());
}

TEST(InTakersThread, WhatTheWorkThrowsIsThrown) {
  Inbox inbox;
  auto taken = std::async(std::launch::async, [&inbox] { return inbox.take(); });
  EXPECT_THROW(inTakersThread(inbox, [] { throw std::invalid_argument("no"); }), std::invalid_argument);
  inbox.close();
  EXPECT_FALSE(taken.get());
  EXPECT_THROW(inTakersThread(inbox, [] {}), std::future_error) << "its taker has ended";
}

TEST(Inbox, RangesWaitForThePairThatIsNotBeforeThem) {
  Inbox inbox;
  for (const double stamp_s : {1.0, 1.5, 2.0}) inbox.put(rangeAt(stamp_s));
  EXPECT_EQ(inbox.takeRanges(ros::Time(1.5)).size(), 2u);
  EXPECT_EQ(inbox.takeRanges(ros::Time(1.9)).size(), 0u);
  EXPECT_EQ(inbox.takeRanges(ros::Time(2.0)).size(), 1u);
}

TEST(Inbox, ARangeFromTheFutureHoldsUpNoOther) {
  Inbox inbox;
  for (const double stamp_s : {1.0, 1.8, 1.1}) inbox.put(rangeAt(stamp_s));
  EXPECT_EQ(inbox.takeRanges(ros::Time(1.2)).size(), 2u);
  EXPECT_EQ(inbox.takeRanges(ros::Time(1.8)).size(), 1u);
}

TEST(Inbox, AKilohertzLidarAndLateImagesLoseNoRange) {
  Inbox inbox;
  inbox.takeRanges(ros::Time(9.0));
  for (int i = 0; i < 1000; ++i) inbox.put(rangeAt(9.0 + 0.001 * (i + 1)));
  EXPECT_EQ(inbox.takeRanges(ros::Time(10.0)).size(), 1000u);
}

TEST(Inbox, RangesFromBeforeATimeJumpAreForgottenWithoutAWord) {
  Inbox inbox;
  inbox.takeRanges(ros::Time(100.0));
  inbox.put(rangeAt(100.5));
  inbox.put(rangeAt(1.0));
  EXPECT_EQ(inbox.takeRanges(ros::Time(1.0)).size(), 1u);
  EXPECT_EQ(inbox.takeRanges(ros::Time(200.0)).size(), 0u);
  EXPECT_EQ(inbox.refusedRanges().count, 0u);
}

TEST(Inbox, ReadingsWithoutAStampAreRefusedAndCounted) {
  Inbox inbox;
  inbox.takeRanges(ros::Time(1.0));
  inbox.takeImu(ros::Time(1.0));
  for (const double stamp_s : {1.05, 0.0, 1.1}) inbox.put(rangeAt(stamp_s));
  inbox.put(imuAt(0.0));
  EXPECT_EQ(inbox.takeRanges(ros::Time(1.1)).size(), 2u);
  EXPECT_EQ(inbox.takeImu(ros::Time(1.1)).size(), 0u);
  EXPECT_EQ(inbox.refusedRanges().count, 1u);
  EXPECT_TRUE(std::isnan(inbox.refusedRanges().difference_s));
  EXPECT_EQ(inbox.refusedImu().count, 1u);
}

TEST(Inbox, KnowsTheFramesOfAllRangesInTheOrderOfTheirFirst) {
  Inbox inbox;
  for (const char* frame : {"/down", "front", "down"}) {
    const auto range = boost::make_shared<sensor_msgs::Range>();
    range->header.frame_id = frame;
    inbox.put(sensor_msgs::RangeConstPtr(range));
  }
  EXPECT_EQ(inbox.rangeFrames(), (std::vector<std::string>{"down", "front"}));
}

TEST(Inbox, ALateRangeIsNoTimeJump) {
  Inbox inbox;
  inbox.put(rangeAt(10.0));
  inbox.put(rangeAt(9.9));
  EXPECT_EQ(inbox.takeRanges(ros::Time(10.0)).size(), 2u);
}

TEST(Inbox, ImuReadingsWaitOnTheirOwn) {
  Inbox inbox;
  inbox.put(rangeAt(1.0));
  for (const double stamp_s : {0.9, 1.0, 1.1, 1.2}) inbox.put(imuAt(stamp_s));
  const auto taken = inbox.takeImu(ros::Time(1.1));
  ASSERT_EQ(taken.size(), 3u);
  EXPECT_EQ(taken.front()->header.stamp, ros::Time(0.9));
  EXPECT_EQ(inbox.takeImu(ros::Time(1.2)).size(), 1u);
  EXPECT_EQ(inbox.takeRanges(ros::Time(1.0)).size(), 1u);
}

}  // namespace
}  // namespace flight_corridor_ros
