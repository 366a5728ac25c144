#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <random>

#include "flight_corridor/geometry/section.hpp"
#include "support/calibrations.hpp"
#include "support/corridor_box.hpp"
#include "support/random_pose.hpp"

namespace flight_corridor {
namespace {

using test_support::kCorridor;
using test_support::kVgaGeometry;
using test_support::randomPose;

/// In the box's frame, its end included.
bool holds(const Box& box, const Eigen::Vector3d& point_C) {
  const Eigen::Vector3d point_F = box.T_M_F.inverse() * point_C;
  return 0.0 <= point_F.x() && point_F.x() <= box.size_m.x() && 2.0 * std::abs(point_F.y()) <= box.size_m.y() &&
         2.0 * std::abs(point_F.z()) <= box.size_m.z();
}

TEST(Section, OfAStraightBoxItIsItsWidthAndHeight) {
  for (const double depth_m : {1.5, 2.0, 3.3, 4.0}) {
    const Section section = sectionAt(kCorridor, depth_m, kVgaGeometry);
    EXPECT_NEAR(section.area_m2, 1.2 * 0.4, 1e-9) << depth_m;
    const double pixel_m = depth_m / kVgaGeometry.calibration().fx_px;
    EXPECT_NEAR(section.view.width * pixel_m, 1.2, 3.0 * pixel_m) << depth_m;
    EXPECT_NEAR(section.view.height * pixel_m, 0.4, 3.0 * pixel_m) << depth_m;
    EXPECT_NEAR(section.view.x + 0.5 * (section.view.width - 1), kVgaGeometry.calibration().cx_px, 0.51);
  }
}

TEST(Section, WhereTheBoxIsNotThereIsNone) {
  const Box ahead{opticalFromForward() * Eigen::Translation3d(1.0, 0.0, 0.0), {2.0, 1.2, 0.4}};
  for (const double depth_m : {0.9, 3.1, 0.0, -1.0, kNaN}) {
    EXPECT_EQ(sectionAt(ahead, depth_m, kVgaGeometry).area_m2, 0.0) << depth_m;
    EXPECT_TRUE(sectionAt(ahead, depth_m, kVgaGeometry).view.empty()) << depth_m;
  }
  const Box behind{opticalFromForward() * Eigen::Translation3d(-5.0, 0.0, 0.0), {4.0, 1.2, 0.4}};
  EXPECT_TRUE(viewOfEnd(behind, kVgaGeometry).empty());
  EXPECT_TRUE(viewOfFarPart(behind, kVgaGeometry).empty());
}

TEST(Section, BesideTheImageItHasAnAreaButNoView) {
  const Box beside{opticalFromForward() * Eigen::Translation3d(0.0, 9.0, 0.0), {4.0, 1.2, 0.4}};
  const Section section = sectionAt(beside, 3.0, kVgaGeometry);
  EXPECT_NEAR(section.area_m2, 1.2 * 0.4, 1e-9);
  EXPECT_TRUE(section.view.empty());
}

TEST(Section, EveryPixelWhoseRayIsInTheBoxThereIsInItsView) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> depth(0.3, 5.0);
  std::uniform_int_distribution<int> column(0, 639), row(0, 479);
  int in_view = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Box box{randomPose(random, 1.0), {2.0, 1.2, 0.8}};
    box.T_M_F.translation().z() += 2.0;
    const double depth_m = depth(random);
    const Section section = sectionAt(box, depth_m, kVgaGeometry);
    EXPECT_EQ(section.view & cv::Rect({0, 0}, kVgaGeometry.size()), section.view);
    for (int i = 0; i < 200; ++i) {
      const cv::Point pixel(column(random), row(random));
      if (!holds(box, kVgaGeometry.point(pixel.x, pixel.y, depth_m))) continue;
      EXPECT_TRUE(section.view.contains(pixel)) << trial << ": " << pixel;
      ++in_view;
    }
  }
  EXPECT_GT(in_view, 500);
}

TEST(Section, NoPointOfTheBoxThereIsOutsideItsRectangle) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> side(-3.0, 3.0);
  for (int trial = 0; trial < 100; ++trial) {
    Box box{randomPose(random, 0.5), {2.0, 1.2, 0.8}};
    box.T_M_F.translation().z() += 2.0;
    const double depth_m = centre(box).z();
    Eigen::AlignedBox2d held;
    for (int i = 0; i < 500; ++i) {
      const Eigen::Vector3d point_C(side(random), side(random), depth_m);
      if (holds(box, point_C)) held.extend(Eigen::Vector2d(point_C.head<2>()));
    }
    const double held_m2 = held.isEmpty() ? 0.0 : held.sizes().prod();
    EXPECT_LE(held_m2, sectionAt(box, depth_m, kVgaGeometry).area_m2 + 1e-9) << trial;
  }
}

TEST(Section, TheFarPartOfAStraightBoxIsLargerInViewThanItsEnd) {
  const cv::Rect end = viewOfEnd(kCorridor, kVgaGeometry), far_part = viewOfFarPart(kCorridor, kVgaGeometry);
  EXPECT_EQ(end & far_part, end);
  EXPECT_GT(far_part.area(), end.area());
}

}  // namespace
}  // namespace flight_corridor
