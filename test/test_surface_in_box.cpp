#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "flight_corridor/corridor/surface_in_box.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

using test_support::kVgaGeometry;

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
const Eigen::Isometry3d kHere = Eigen::Isometry3d::Identity();
const Eigen::Vector3d kBesideRight_C(0.65, 0.05, 3.05);  // centre of a cell that touches the box's right side
const Eigen::Vector3d kInside_C(0.05, 0.05, 3.05);
constexpr double kNear_m = 3.0;

/// 1.2 m wide, 0.4 m high, 4 m long, from the camera along its axis.
Box corridor(const Eigen::Isometry3d& T_M_C) {
  Box box;
  box.T_M_F = T_M_C * opticalFromForward();
  box.size_m = {4.0, 1.2, 0.4};
  return box;
}

/// Nothing but a part of a plane across, from left_m to right_m and all heights.
cv::Mat strip(float depth_m, double left_m, double right_m) {
  cv::Mat image(kVgaGeometry.size(), CV_32FC1, cv::Scalar(kNothing));
  for (int u = 0; u < image.cols; ++u) {
    const double x_m = kVgaGeometry.point(u, 0, depth_m).x();
    if (left_m <= x_m && x_m <= right_m) image.col(u).setTo(depth_m);
  }
  return image;
}

double begin(const cv::Mat& depth_m, const Eigen::Vector3d& cell_centre_C, double scale_sigma = 0.0) {
  SurfaceInBox surface(MapConfig(), kVgaGeometry, depth_m, scale_sigma, kHere, corridor(kHere));
  return surface.begin(cell_centre_C, kNear_m);
}

TEST(SurfaceInBox, BeginsWhereTheSurfaceDoesNotWhereTheCellDoes) {
  EXPECT_NEAR(begin(strip(3.06f, -1.0, 1.0), kInside_C), 3.06, 1e-6);
  EXPECT_NEAR(begin(strip(3.09f, -1.0, 1.0), kInside_C), 3.09, 1e-6);
}

TEST(SurfaceInBox, SurfacesBesideTheBoxAreNotInItThoughTheirCellTouchesIt) {
  EXPECT_EQ(begin(strip(3.06f, 0.66, 1.0), kBesideRight_C), kInfinity);
}

TEST(SurfaceInBox, SurfacesThatReachIntoTheBoxAreInIt) {
  EXPECT_NEAR(begin(strip(3.06f, 0.57, 1.0), kBesideRight_C), 3.06, 1e-6);
}

TEST(SurfaceInBox, SurfacesThatAnErrorOfTheirEdgeMayHaveMovedOutAreInIt) {
  EXPECT_NEAR(begin(strip(3.06f, 0.63, 1.0), kBesideRight_C), 3.06, 1e-6);
}

TEST(SurfaceInBox, AFewNearerPointsAreNoise) {
  cv::Mat depth_m = strip(3.08f, -1.0, 1.0);
  depth_m.row(245).setTo(3.04f);  // of the 12 rows that show the cell
  EXPECT_NEAR(begin(depth_m, kInside_C), 3.08, 1e-6);
}

TEST(SurfaceInBox, CellsThatTheImageDoesNotShowAreAllThatIsKnown) {
  EXPECT_EQ(begin(strip(2.0f, -9.0, 9.0), kBesideRight_C), kNear_m) << "hidden";
  EXPECT_EQ(begin(strip(3.06f, -9.0, -8.0), kBesideRight_C), kNear_m) << "not matched";
  EXPECT_EQ(begin(strip(3.06f, 0.695, 0.70), kBesideRight_C), kNear_m) << "too few points";
  EXPECT_EQ(begin(strip(3.06f, 2.6, 9.0), {2.75, 0.05, 3.05}), kNear_m) << "partly beside the image";
  EXPECT_EQ(begin(strip(3.06f, -9.0, 9.0), {0.65, 0.05, -3.05}), kNear_m) << "behind the camera";
}

TEST(SurfaceInBox, SurfacesThatAWrongScaleMayHaveMovedOutAreInIt) {
  EXPECT_EQ(begin(strip(3.06f, 0.655, 1.0), kBesideRight_C, 0.01), kInfinity);
  EXPECT_NEAR(begin(strip(3.06f, 0.655, 1.0), kBesideRight_C, 0.09), 3.06, 1e-6);
  for (const double unknown : {kNaN, kInfinity}) {
    EXPECT_NEAR(begin(strip(3.06f, -1.0, 1.0), kInside_C, unknown), 3.06, 1e-6) << unknown;
    EXPECT_NEAR(begin(strip(3.06f, 0.68, 1.0), kBesideRight_C, unknown), 3.06, 1e-6) << unknown;
  }
}

TEST(SurfaceInBox, ARememberedCellJustBeforeTheSurfaceIsThatSurface) {
  EXPECT_EQ(begin(strip(3.16f, -9.0, 9.0), kInside_C), kInfinity);
}

TEST(SurfaceInBox, RememberedCellsThatTheImageMayHaveLostAreAllThatIsKnown) {
  EXPECT_EQ(begin(strip(8.0f, -9.0, 9.0), kInside_C), kNear_m) << "seen through, up to far behind it";
  const cv::Mat left_of_it = strip(3.16f, -9.0, 3.16 / 3.05 * (kInside_C.x() + 0.03));
  EXPECT_EQ(begin(left_of_it, kInside_C), kNear_m) << "some rays have no end";
  cv::Mat with_a_thread = strip(3.16f, -9.0, 9.0);
  const Eigen::Vector2d middle_px = kVgaGeometry.project(kInside_C);
  with_a_thread.at<float>(static_cast<int>(middle_px.y()), static_cast<int>(middle_px.x())) = 3.06f;
  EXPECT_EQ(begin(with_a_thread, kInside_C), kNear_m) << "a little of it is still seen";
}

TEST(SurfaceInBox, WhatLiesBehindTheBoxesEndIsNotInIt) {
  const Eigen::Vector3d last_C(0.05, 0.05, 4.03);  // of a map that is not aligned with the box
  EXPECT_EQ(begin(strip(4.07f, -1.0, 1.0), last_C), kInfinity);
  EXPECT_EQ(begin(strip(4.04f, -1.0, 1.0), last_C), 4.0) << "within a match's error of the end";
}

TEST(SurfaceInBox, MovingMapAndCameraTogetherKeepsTheAnswer) {
  Eigen::Isometry3d T_M_C = Eigen::Isometry3d::Identity();
  T_M_C.translation() << 3.0, -2.0, 1.0;
  T_M_C.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  for (const double left_m : {0.57, 0.66}) {
    const cv::Mat depth_m = strip(3.06f, left_m, 1.0);
    SurfaceInBox surface(MapConfig(), kVgaGeometry, depth_m, 0.0, T_M_C, corridor(T_M_C));
    const double here_m = begin(depth_m, kBesideRight_C), there_m = surface.begin(T_M_C * kBesideRight_C, kNear_m);
    EXPECT_EQ(std::isfinite(there_m), std::isfinite(here_m)) << left_m;
    EXPECT_FALSE(std::abs(there_m - here_m) > 1e-6) << left_m;
  }
}

}  // namespace
}  // namespace flight_corridor
