#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "support/calibrations.hpp"
#include "support/parallel_wires.hpp"
#include "support/temporary_folder.hpp"
#include "support/wall_scene.hpp"
#include "tools/pictures.hpp"

namespace flight_corridor::tools {
namespace {

using test_support::wallFrame;

TEST(ToolsPictures, AChangeOfVerdictIsDrawnWithItsEvidence) {
  const test_support::TemporaryFolder folder;
  const StereoGeometry geometry(test_support::smallCalibration());
  Pipeline pipeline(Config(), geometry, Rig());
  PictureOptions options;
  options.overlay_folder = folder.path("overlays");
  Pictures pictures(options);
  const auto add = [&](std::size_t index) {
    const StereoFrame frame = wallFrame(geometry, 7, 1.0 + 0.1 * static_cast<double>(index));  // 3 m
    const Report& report = pipeline.process(frame);
    pictures.add(index, frame.left, pipeline, report);
  };
  add(0);
  add(1);
  const cv::Mat drawn = cv::imread(options.overlay_folder + "/000000_BLOCKED.png");
  EXPECT_EQ(drawn.size(), geometry.size() * 2);  // overlay and matched depth above, filled depth and map below
  EXPECT_FALSE(std::filesystem::exists(options.overlay_folder + "/000001_BLOCKED.png")) << "no change";
}

TEST(ToolsPictures, WhatFitsInTheBoxAsWellIsWhiteOnTheMatchedDepth) {
  const test_support::TemporaryFolder folder;
  const test_support::ParallelWires wires;
  Pipeline pipeline(Config(), wires.geometry, Rig());
  PictureOptions options;
  options.overlay_folder = folder.path("overlays");
  const Report& report = pipeline.process(wires.frame);
  Pictures(options).add(0, wires.frame.left, pipeline, report);
  const cv::Mat drawn = cv::imread(options.overlay_folder + "/000000_" + toString(report.verdict.state) + ".png");
  const cv::Size size = wires.geometry.size();
  ASSERT_EQ(drawn.size(), size * 2);
  const cv::Rect above_caption(0, 0, size.width, size.height - 40);
  cv::Mat white;
  cv::inRange(drawn(above_caption + cv::Point(size.width, 0)), cv::Scalar::all(255), cv::Scalar::all(255), white);
  EXPECT_EQ(cv::countNonZero((white > 0) != (pipeline.doubtful()(above_caption) > 0)), 0);
  EXPECT_GT(cv::countNonZero(white), 100);
}

}  // namespace
}  // namespace flight_corridor::tools
