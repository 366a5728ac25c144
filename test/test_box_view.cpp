#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "flight_corridor/geometry/box_view.hpp"
#include "support/calibrations.hpp"
#include "support/corridor_box.hpp"
#include "support/random_pose.hpp"

namespace flight_corridor {
namespace {

using test_support::kBlind_m;
using test_support::kCorridor;
using test_support::kSmallGeometry;

TEST(BoxView, TheAxisLeavesAtTheEndARayBesideItThroughASide) {
  BoxView view(kSmallGeometry);
  view.look(kCorridor, kBlind_m);
  const StereoCalibration& rig = kSmallGeometry.calibration();
  const int u = static_cast<int>(rig.cx_px), v = static_cast<int>(rig.cy_px);
  EXPECT_NEAR(view.exit().at<float>(v, u), kSmallGeometry.disparity(4.0), 1e-4);
  EXPECT_NEAR(view.entry().at<float>(v, u), kSmallGeometry.disparity(kBlind_m), 1e-3);
  const int beside = u + static_cast<int>(rig.fx_px * 0.6 / 2.0);  // leaves half-way
  EXPECT_NEAR(kSmallGeometry.depth(view.exit().at<float>(v, beside)), 2.0, 0.05);
}

TEST(BoxView, AgreesWithPointsAlongTheRays) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const Box box{test_support::randomPose(random, 1.0) * opticalFromForward(), {3.0, 1.0, 0.7}};
    BoxView view(kSmallGeometry);
    view.look(box, kBlind_m);
    for (int i = 0; i < 200; ++i) {
      const int u = static_cast<int>(random() % 320), v = static_cast<int>(random() % 240);
      const double depth_m = kBlind_m + 6.0 * (random() % 1000) / 1000.0;
      const double d = kSmallGeometry.disparity(depth_m), edge = 0.01 * d;
      const float entry = view.entry().at<float>(v, u), exit = view.exit().at<float>(v, u);
      if (std::abs(d - entry) < edge || std::abs(d - exit) < edge) continue;
      EXPECT_EQ(exit < d && d < entry, contains(box, kSmallGeometry.point(u, v, depth_m)))
          << u << ' ' << v << ' ' << depth_m;
    }
  }
}

TEST(BoxView, ABoxBehindTheCameraIsNotSeen) {
  BoxView view(kSmallGeometry);
  view.look(kCorridor, kBlind_m);
  Box behind = kCorridor;
  behind.T_M_F.translation().z() = -10.0;
  view.look(behind, kBlind_m);
  EXPECT_EQ(cv::countNonZero(view.exit() > -1e9), 0);
}

}  // namespace
}  // namespace flight_corridor
