#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <sensor_msgs/CameraInfo.h>

#include <cmath>
#include <fstream>
#include <tuple>

#include "ros/conversions.hpp"
#include "support/raw_rig.hpp"
#include "support/rewrite_bag.hpp"
#include "support/wall_bag.hpp"

namespace flight_corridor::tools {
namespace {

using test_support::kBaseline_m;
using test_support::kFocal_px;
using test_support::RawRig;

constexpr int kDisparity_px = 6;
const char* const kSides[] = {"/cam0/", "/cam1/"};

/// The wall, as two cameras with lenses see it.
class RawBagTest : public test_support::WallBagTest {
 protected:
  RawBagTest() { cv::GaussianBlur(texture, texture, {}, 1.5); }  // what survives being interpolated twice

  /// Images become raw ones; infos and images move to other topics.
  /// @param extension ".png": compressed; "": not.
  void makeRaw(const RawRig& raw, const std::string& image, const std::string& extension, bool with_infos) const {
    const StereoTopics topics;
    test_support::rewriteBag(path(), [&](const rosbag::MessageInstance& message, rosbag::Bag& out) {
      const std::string topic = message.getTopic();
      const bool is_left = topic == topics.left || topic == topics.left_info;
      const auto& camera = is_left ? raw.cameras.left : raw.cameras.right;
      const std::string side = kSides[is_left ? 0 : 1];
      if (topic == topics.left || topic == topics.right) {
        const auto clean = message.instantiate<sensor_msgs::Image>();
        const auto warped = flight_corridor_ros::toImage(
            clean->header, test_support::toRaw(camera, cv_bridge::toCvShare(clean)->image), clean->encoding);
        if (extension.empty()) return out.write(side + image, message.getTime(), warped);
        out.write(side + image + "/compressed", message.getTime(), test_support::compress(warped, extension));
      } else if (topic == topics.left_info || topic == topics.right_info) {
        sensor_msgs::CameraInfo info = camera;
        info.header = message.instantiate<sensor_msgs::CameraInfo>()->header;
        if (with_infos) out.write(side + "camera_info", message.getTime(), info);
      } else {
        test_support::copyMessage(message, out);
      }
    });
  }

  Report lastReport(const BagReading& reading) const {
    const StereoBagReader bag(path(), {"", "", "", "", "", "", ""}, reading);
    Report last;
    Replayer(bag, config).run([&](const Answer& answer) { last = answer.report; });
    return last;
  }

  /// A quarter of a pixel, for the interpolation: Z^2 / (f B) / 4 = 0.075 m.
  static void expectSame(const Report& raw, const Report& clean) {
    EXPECT_EQ(raw.verdict.state, clean.verdict.state);
    EXPECT_NEAR(raw.range_stereo_m, clean.range_stereo_m, 0.075);
    EXPECT_EQ(raw.range_lidar_m, clean.range_lidar_m);
  }
};

TEST_F(RawBagTest, RawImagesGiveTheVerdictOfTheRectifiedOnes) {
  for (const bool is_equidistant : {false, true}) {
    const RawRig raw = test_support::makeRawRig(rig.calibration, is_equidistant);
    for (const char* extension : {"", ".png"}) {
      writeWall(kDisparity_px);
      const Report clean = replay().back();
      ASSERT_EQ(clean.verdict.state, State::Blocked);
      makeRaw(raw, "image_raw", extension, true);
      expectSame(lastReport({}), clean);
    }
  }
}

TEST_F(RawBagTest, ACalibrationFileStandsForTheInfos) {
  writeWall(kDisparity_px);
  const Report clean = replay().back();
  const RawRig raw = test_support::makeRawRig(rig.calibration, false);
  makeRaw(raw, "image_raw", "", false);
  std::ofstream(folder.path("camchain.yaml")) << test_support::kalibrYaml(raw);
  expectSame(lastReport({{folder.path("camchain.yaml")}}), clean);
  EXPECT_THROW(lastReport({}), std::runtime_error) << "neither CameraInfo nor calibration";
  EXPECT_THROW(lastReport({{folder.path("camchain.yaml")}, ImageState::Rectified}), std::runtime_error);
}

TEST_F(RawBagTest, ImagesNamedOrDeclaredRectifiedStayAsTheyAre) {
  RawRig raw = test_support::makeRawRig(rig.calibration, false);
  for (const auto& [name, given, is_raw] :
       {std::tuple("image_raw", ImageState::AsNamed, true), std::tuple("image_raw", ImageState::Rectified, false),
        std::tuple("image_rect", ImageState::AsNamed, false), std::tuple("image_rect_color", ImageState::Raw, true)}) {
    writeWall(kDisparity_px);
    makeRaw(raw, name, "", true);
    const StereoBagReader bag(path(), {"", "", "", "", "", "", ""}, {{}, given});
    bool has_distortion = false;
    bag.play({}, {[&](const RecordedPair& pair) { has_distortion = pair.left_info->D[0] != 0.0; },
                  [](const sensor_msgs::RangeConstPtr&) {}});
    EXPECT_EQ(has_distortion, !is_raw) << name;
  }
}

TEST_F(RawBagTest, ALensThatIsNotKnownIsNamedAtTheStart) {
  writeWall(kDisparity_px);
  makeRaw(test_support::makeRawRig(rig.calibration, false), "image_raw", "", true);
  test_support::rewriteBag(path(), [&](const rosbag::MessageInstance& message, rosbag::Bag& out) {
    const auto info = message.instantiate<sensor_msgs::CameraInfo>();
    if (!info) return test_support::copyMessage(message, out);
    info->distortion_model = "magnifier";
    out.write(message.getTopic(), message.getTime(), *info);
  });
  try {
    lastReport({});
    FAIL() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("lens model \"magnifier\""), std::string::npos) << error.what();
  }
}

/// Rectified images that are not called so, of a driver that leaves R out.
TEST_F(RawBagTest, ARotationOfZerosIsNone) {
  writeWall(kDisparity_px);
  const Report clean = replay().back();
  RawRig ideal;
  ideal.cameras = camerasOf(rig.calibration);
  makeRaw(ideal, "image", "", true);
  test_support::rewriteBag(path(), [&](const rosbag::MessageInstance& message, rosbag::Bag& out) {
    const auto info = message.instantiate<sensor_msgs::CameraInfo>();
    if (!info) return test_support::copyMessage(message, out);
    info->R.fill(0.0);
    info->D.clear();
    info->distortion_model.clear();
    out.write(message.getTopic(), message.getTime(), *info);
  });
  expectSame(lastReport({}), clean);
  EXPECT_THROW(lastReport({{}, ImageState::Raw}), std::runtime_error) << "how to turn them is not known";
}

TEST_F(RawBagTest, WhatIsReadOfTheCalibrationIsSaid) {
  writeWall(kDisparity_px);
  const RawRig raw = test_support::makeRawRig(rig.calibration, true);
  makeRaw(raw, "image_raw", "", true);
  const std::string with_infos = StereoBagReader(path(), {"", "", "", "", "", "", ""}).describe();
  EXPECT_NE(with_infos.find("\ncalibration: left equidistant of 4 coefficients, "), std::string::npos) << with_infos;
  std::ofstream(folder.path("camchain.yaml")) << test_support::kalibrYaml(raw);
  const std::string with_file =
      StereoBagReader(path(), {"", "", "", "", "", "", ""}, {{folder.path("camchain.yaml")}}).describe();
  EXPECT_NE(with_file.find("\ncalibration: left cam0 equidistant of 4 coefficients, "), std::string::npos) << with_file;
}

TEST_F(RawBagTest, APairThatCannotBeRectifiedIsUnknown) {
  writeWall(kDisparity_px);
  RawRig raw = test_support::makeRawRig(rig.calibration, false);
  raw.cameras.right.width = 77;
  makeRaw(raw, "image_raw", "", true);
  const Report report = lastReport({});
  EXPECT_EQ(report.verdict.state, State::Unknown);
}

/// The pose of the LiDAR can be given by hand instead of by tf, also where the images name no frame.
TEST_F(RawBagTest, TheLidarsPoseCanBeGiven) {
  rig.T_B_L = Eigen::Translation3d(0.05, 0.02, -0.03) * Eigen::Isometry3d(test_support::turned(0.0, 0.02, 0.03));
  writeWall(kDisparity_px);
  const Report with_tf = replay().back();
  for (const char* frame : {"stereo_left_optical", ""}) {
    writeWall(kDisparity_px);
    test_support::rewriteBag(path(), [&](const rosbag::MessageInstance& message, rosbag::Bag& out) {
      if (message.getTopic() == kStaticTransformTopic) return;
      const auto image = message.instantiate<sensor_msgs::Image>();
      if (!image) return test_support::copyMessage(message, out);
      image->header.frame_id = frame;
      out.write(message.getTopic(), message.getTime(), image);
    });
    EXPECT_TRUE(std::isnan(lastReport({}).range_lidar_m) || lastReport({}).verdict.reasons & kNoLidar);
    const Report given = lastReport({{}, ImageState::AsNamed, rig.T_B_L});
    EXPECT_EQ(given.verdict.state, with_tf.verdict.state);
    EXPECT_NEAR(given.range_lidar_m, with_tf.range_lidar_m, 1e-9);
    EXPECT_NEAR(given.range.range_m, with_tf.range.range_m, 1e-6);
  }
}

}  // namespace
}  // namespace flight_corridor::tools
