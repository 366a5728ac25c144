#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "sim/shutter.hpp"

namespace flight_corridor::sim {
namespace {

constexpr double kDepth_m = 5.0;
constexpr double kSpeed_m_s = 2.0;

/// A black board that moves to the left before the sky; the camera stands still.
Scene movingBoard(double exposure_s) {
  Scene scene;
  scene.rig = defaultRig();
  scene.rig.exposure_s = exposure_s;
  scene.flight.speed_m_s = 0.0;
  scene.flight.wobble_rad.setZero();
  scene.flight.sway_m.setZero();
  Material black;
  black.grey = 0.0f;
  black.contrast = 0.0f;
  const double x_m = scene.rig.T_B_C.translation().x() + kDepth_m + 0.05;
  Primitive board = makeBox({x_m, 0.0, scene.flight.start_W.z()}, {0.1, 0.5, 0.5}, black);
  board.velocity_W = {0.0, kSpeed_m_s, 0.0};
  scene.world = {board};
  return scene;
}

/// The middle row, 1 where it is black.
cv::Mat darkness(double exposure_s) {
  return 1.0 - collectLight(movingBoard(exposure_s), 1.0 / 8.0, leftCamera).row(240);
}

TEST(CollectLight, SmearsWhatMovesOverItsWayDuringTheExposure) {
  constexpr double kExposure_s = 0.03;
  const cv::Mat sharp = darkness(0.0), smeared = darkness(kExposure_s);
  const double way_px = 350.0 * kSpeed_m_s * kExposure_s / kDepth_m;  // 4.2 px, between the middles of five moments 3.4
  const int longer_px = cv::countNonZero(smeared > 0.0f) - cv::countNonZero(sharp > 0.0f);
  // Both edges of a board that moves by the way: it covers that much more; pixels that are touched count as wholes.
  EXPECT_NEAR(longer_px, 0.8 * way_px, 1.5);
  // Light is only moved. Each edge is placed to one of eight columns.
  EXPECT_NEAR(cv::sum(smeared)[0], cv::sum(sharp)[0], 2.0 / 8.0);
}

TEST(CollectLight, IsCentredOnItsMoment) {
  const auto centre = [](const cv::Mat& row) {
    double sum = 0.0;
    for (int u = 0; u < row.cols; ++u) sum += u * row.at<float>(0, u);
    return sum / cv::sum(row)[0];
  };
  EXPECT_NEAR(centre(darkness(0.03)), centre(darkness(0.0)), 1.0 / 8.0);
}

}  // namespace
}  // namespace flight_corridor::sim
