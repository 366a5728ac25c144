// Images that are not the usual ones of 8 bits with light all over.

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <string>
#include <utility>

#include "support/contains.hpp"
#include "support/processor_test.hpp"

namespace flight_corridor_ros {
namespace {

using namespace flight_corridor;
using namespace test_support;
using flight_corridor::test_support::contains;

class ProcessorImagesTest : public ProcessorTest {
 protected:
  /// As of a sensor of 16 bits of which the scene fills few counts.
  static void spread(sensor_msgs::Image& image, int least, int counts, bool is_bigendian = false) {
    cv::Mat grey(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC1, image.data.data()), deep;
    grey.convertTo(deep, CV_16UC1, counts / 255.0, least);
    const auto message = toImage(image.header, deep, "mono16");
    for (std::size_t i = 0; is_bigendian && i < message->data.size(); i += 2) {
      std::swap(message->data[i], message->data[i + 1]);
    }
    message->is_bigendian = is_bigendian;
    image = *message;
  }

  /// Verdict and log.
  std::pair<Verdict, std::string> show(StereoInputs& inputs, double after_s = 0.0) {
    inputs.stamp(kStart + ros::Duration(after_s));
    testing::internal::CaptureStderr();
    const Verdict verdict = Processor(config, transforms, inbox).process(messages(inputs)).verdict;
    return {verdict, testing::internal::GetCapturedStderr()};
  }
};

TEST_F(ProcessorImagesTest, AFewCountsOfSixteenBitsGiveTheVerdictOfEight) {
  for (const auto& [least, counts] : {std::pair(7200, 200), {7200, 400}, {100, 8000}, {40000, 1500}, {0, 65535}}) {
    for (const double wall_m : {kNear_m, kFar_m}) {
      for (const bool is_bigendian : {false, true}) {
        StereoInputs inputs(wall_m);
        const auto expected = show(inputs).first;
        ASSERT_EQ(expected.state, wall_m == kNear_m ? State::Blocked : State::Free);
        for (const auto& image : {inputs.left, inputs.right}) spread(*image, least, counts, is_bigendian);
        const auto [verdict, log] = show(inputs);
        EXPECT_EQ(verdict.state, expected.state) << least << "+" << counts << describeReasons(verdict.reasons) << log;
        EXPECT_EQ(log, "") << least << "+" << counts;
      }
    }
  }
}

TEST_F(ProcessorImagesTest, FrozenAndDoubledImagesOfFewCountsAreNoticed) {
  StereoInputs inputs(kFar_m);
  for (const auto& image : {inputs.left, inputs.right}) spread(*image, 7200, 200);
  for (const double after_s : {0.0, 0.1}) {
    inputs.stamp(kStart + ros::Duration(after_s));
    processor.process(messages(inputs));
  }
  EXPECT_TRUE(processor.report().verdict.reasons & kFrozenImage);
  inputs.right->data = inputs.left->data;
  EXPECT_TRUE(show(inputs).first.reasons & kBadImage);
}

TEST_F(ProcessorImagesTest, AnImageThatIsNearlyBlackIsNamed) {
  for (const bool is_right : {true, false}) {
    StereoInputs inputs(kFar_m);
    sensor_msgs::Image& image = is_right ? *inputs.right : *inputs.left;
    for (auto& grey : image.data) grey = static_cast<std::uint8_t>(grey / 64);
    const auto [verdict, log] = show(inputs);
    EXPECT_EQ(verdict.state, State::Unknown);
    const std::string side = is_right ? "right" : "left";
    EXPECT_TRUE(contains(log, "100 % of the " + side + " image is black")) << log;
  }
}

TEST_F(ProcessorImagesTest, ABorderThatRectificationLeftIsNamed) {
  StereoInputs inputs(kFar_m);
  for (const auto& message : {inputs.left, inputs.right}) {
    cv::Mat grey(480, 640, CV_8UC1, message->data.data()), inside(grey, cv::Rect(100, 80, 440, 320));
    const cv::Mat kept = inside.clone();
    grey = cv::Scalar(0);
    kept.copyTo(inside);
  }
  const auto [verdict, log] = show(inputs);
  EXPECT_EQ(verdict.state, State::Unknown) << describeReasons(verdict.reasons);
  EXPECT_TRUE(contains(log, "54 % of the left image is black")) << log;
  EXPECT_TRUE(contains(log, "alpha")) << log;
  EXPECT_FALSE(contains(log, "FREE")) << log;
}

TEST_F(ProcessorImagesTest, WhatIsFreeGetsNoWordAboutBlack) {
  StereoInputs inputs(kFar_m);
  const auto [verdict, log] = show(inputs);
  EXPECT_EQ(verdict.state, State::Free);
  EXPECT_EQ(log, "");
}

}  // namespace
}  // namespace flight_corridor_ros
