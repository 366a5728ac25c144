#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "flight_corridor/stereo_geometry.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

using test_support::vgaCalibration;

TEST(StereoGeometry, ProjectUndoesPoint) {
  const StereoGeometry geometry(vgaCalibration());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(0, 639), v(0, 479), z(0.3, 30);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d pixel(u(random), v(random));
    const Eigen::Vector3d p_C = geometry.point(pixel.x(), pixel.y(), z(random));
    EXPECT_LT((geometry.project(p_C) - pixel).norm(), 1e-9);  // double rounding of numbers below 1000
  }
}

TEST(StereoGeometry, DisparityUndoesDepth) {
  const StereoGeometry geometry(vgaCalibration());
  for (double disparity = 0.1; disparity < 128; disparity *= 1.7) {
    EXPECT_NEAR(geometry.disparity(geometry.depth(disparity)), disparity, 1e-12 * disparity);
  }
}

TEST(StereoGeometry, DepthIsFocalLengthTimesBaselineOverDisparity) {
  EXPECT_DOUBLE_EQ(StereoGeometry(vgaCalibration()).depth(10.5), 4.0);  // 350 * 0.12 / 10.5
}

TEST(StereoGeometry, WhatLiesBehindTheCameraHasNoPixelAndNoDisparity) {
  const StereoGeometry geometry(vgaCalibration());
  EXPECT_TRUE(geometry.project({0, 0, -1}).hasNaN());
  EXPECT_TRUE(std::isnan(geometry.disparity(-1.0)));
  EXPECT_TRUE(std::isnan(geometry.depth(0.0)));
  EXPECT_TRUE(std::isnan(geometry.depth(kNaN)));
  EXPECT_FALSE(geometry.contains(geometry.project({0, 0, -1})));
}

TEST(StereoGeometry, DepthSigmaIsTheDerivativeOfDepth) {
  const StereoGeometry geometry(vgaCalibration());
  const double disparity = 9.0, step = 1e-4;
  const double slope = (geometry.depth(disparity - step) - geometry.depth(disparity + step)) / (2 * step);
  EXPECT_NEAR(geometry.depthSigma(geometry.depth(disparity), 1.0), slope, 1e-6 * slope);  // second order of a step
}

TEST(StereoGeometry, ShiftingDepthAddsDisparity) {
  const StereoGeometry geometry(vgaCalibration());
  EXPECT_NEAR(geometry.disparity(geometry.shiftedDepth(4.0, 0.5)), geometry.disparity(4.0) + 0.5, 1e-12);
  EXPECT_EQ(geometry.shiftedDepth(60.0, -0.7), kInfinity);  // 60 m have 0.7 px
  EXPECT_TRUE(std::isnan(geometry.shiftedDepth(kNaN, 0.5)));
}

TEST(StereoGeometry, AForwardFrameLooksAlongTheOpticalAxis) {
  const Eigen::Isometry3d T_C_F = opticalFromForward();
  EXPECT_TRUE((T_C_F * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitZ()));
  EXPECT_TRUE((T_C_F * Eigen::Vector3d::UnitZ()).isApprox(-Eigen::Vector3d::UnitY()));
  EXPECT_DOUBLE_EQ(T_C_F.linear().determinant(), 1.0);
}

TEST(StereoGeometry, RefusesEachImpossibleNumberByName) {
  const auto message = [](auto spoil) {
    StereoCalibration calibration = vgaCalibration();
    spoil(calibration);
    try {
      const StereoGeometry geometry(calibration);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_NE(message([](auto& c) { c.baseline_m = 0.0; }).find("baseline"), std::string::npos);
  EXPECT_NE(message([](auto& c) { c.fx_px = -350.0; }).find("fx"), std::string::npos);
  EXPECT_NE(message([](auto& c) { c.fy_px = kNaN; }).find("fy"), std::string::npos);
  EXPECT_NE(message([](auto& c) { c.size_px = {}; }).find("width"), std::string::npos);
  EXPECT_NE(message([](auto& c) { c.size_px = {640, 1}; }).find("2 or more (640 x 1)"), std::string::npos);
  EXPECT_NE(message([](auto& c) { c.cx_right_px = kInfinity; }).find("right cx"), std::string::npos);
}

}  // namespace
}  // namespace flight_corridor
