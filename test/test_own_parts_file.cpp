#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>

#include "ros/own_parts_file.hpp"
#include "support/contains.hpp"
#include "support/processor_test.hpp"
#include "support/temporary_folder.hpp"

namespace flight_corridor_ros {
namespace {

using namespace flight_corridor;
using flight_corridor::test_support::contains;
using flight_corridor::test_support::TemporaryFolder;
using test_support::kFar_m;
using test_support::kNear_m;
using test_support::kStart;

class OwnPartsFile : public test_support::ProcessorTest {
 protected:
  /// White but for a black rectangle.
  std::string write(const std::string& name, const cv::Size& size, const cv::Rect& covered) const {
    cv::Mat mask(size, CV_8UC1, cv::Scalar(255));
    mask(covered) = 0;
    EXPECT_TRUE(cv::imwrite(folder.path(name), mask));
    return folder.path(name);
  }

  static std::string complaintAbout(const std::string& path) {
    try {
      readOwnParts(path, 1.0);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  }

  /// Of a wall, with this mask; and what is logged.
  std::pair<Verdict, std::string> seeWith(const std::string& path, double scale) {
    config.mask = path;
    config.ros.scale = scale;
    Processor masked(config, transforms, inbox);
    StereoInputs inputs(kFar_m);
    inputs.stamp(kStart);
    testing::internal::CaptureStderr();
    const Verdict verdict = masked.process(messages(inputs)).verdict;
    return {verdict, testing::internal::GetCapturedStderr()};
  }

  using StereoInputs = test_support::StereoInputs;
  TemporaryFolder folder;
};

TEST_F(OwnPartsFile, WithoutOneThereAreNone) { EXPECT_TRUE(readOwnParts("", 1.0).mask.empty()); }

TEST_F(OwnPartsFile, DarkIsCoveredAlsoWithAJpegsErrors) {
  for (const char* name : {"mask.png", "mask.jpg"}) {
    const cv::Mat mask = readOwnParts(write(name, {64, 48}, {10, 20, 30, 10}), 1.0).mask;
    EXPECT_EQ(cv::countNonZero(mask == 0), 30 * 10) << name;
    EXPECT_EQ(cv::countNonZero(mask == 255), 64 * 48 - 30 * 10) << name;
  }
}

TEST_F(OwnPartsFile, AScaledPixelIsCoveredIfAnyOfItsOwnIs) {
  const OwnParts parts = readOwnParts(write("mask.png", {64, 48}, {15, 20, 10, 7}), 0.25);
  cv::Mat expected(12, 16, CV_8UC1, cv::Scalar(255));
  expected(cv::Rect(3, 5, 4, 2)) = 0;  // columns 12 to 27, rows 20 to 27
  ASSERT_EQ(parts.mask.size(), expected.size());
  EXPECT_EQ(cv::norm(parts.mask, expected, cv::NORM_INF), 0.0);
}

TEST_F(OwnPartsFile, ThatIsNoImageIsNamed) {
  std::ofstream(folder.path("mask.txt")) << "black";
  for (const char* name : {"missing.png", "mask.txt", ""}) {
    const std::string path = folder.path(name);
    EXPECT_EQ(complaintAbout(path), "stereo/mask: no readable image (" + path + ")");
    config.mask = path;
    EXPECT_THROW(Processor(config, transforms, inbox), std::invalid_argument) << path;
  }
}

TEST_F(OwnPartsFile, OfAnotherSizeIsNamedWithBothSizes) {
  const std::string path = write("mask.png", {320, 240}, {0, 0, 10, 10});
  const auto [verdict, log] = seeWith(path, 1.0);
  EXPECT_EQ(verdict.reasons, kBadCalibration);
  EXPECT_TRUE(contains(log, "stereo/mask " + path + " is 320 x 240 px, but the left image is 640 x 480 px")) << log;
}

TEST_F(OwnPartsFile, OfTheWholeImagesSizeCoversTheScaledImage) {
  const cv::Rect middle(250, 200, 140, 80);
  for (const double scale : {1.0, 0.5}) {
    EXPECT_EQ(seeWith("", scale).first.state, State::Free) << scale;
    const auto [hidden, log] = seeWith(write("mask.png", {640, 480}, middle), scale);
    EXPECT_EQ(hidden.state, State::Unknown) << scale << log;
    EXPECT_TRUE(hidden.reasons & kUnobserved) << scale;
    EXPECT_EQ(seeWith(write("mask.png", {640, 480}, {0, 0, 640, 60}), scale).first.state, State::Free) << scale;
  }
}

TEST_F(OwnPartsFile, ThatCoversMostOfTheViewIsWarnedOf) {
  testing::internal::CaptureStderr();
  readOwnParts(write("mask.png", {64, 48}, {0, 0, 60, 48}), 1.0);
  EXPECT_TRUE(contains(testing::internal::GetCapturedStderr(), "covers 94 % of the left image"));
}

}  // namespace
}  // namespace flight_corridor_ros
