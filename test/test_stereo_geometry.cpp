#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <random>
#include <stdexcept>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"
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

TEST(StereoGeometry, APixelCoversBaselineOverDisparity) {
  const StereoGeometry geometry(vgaCalibration());
  EXPECT_DOUBLE_EQ(geometry.pixelEdge(10.5), 4.0 / 350.0);
  EXPECT_TRUE(std::isnan(geometry.pixelEdge(0.0)));
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

/// What is said of a calibration that was spoilt.
template <typename Spoil>
std::string message(Spoil spoil) {
  StereoCalibration calibration = vgaCalibration();
  spoil(calibration);
  try {
    const StereoGeometry geometry(calibration);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(StereoGeometry, RefusesABaselineInAnotherUnitAndNamesTheUnit) {
  const auto complaint = [](double baseline_m) { return message([&](auto& c) { c.baseline_m = baseline_m; }); };
  const auto names = [](const std::string& text, const std::string& part) { return text.find(part) != text.npos; };
  for (const double baseline_m : {0.05, 0.12, 0.54}) {
    EXPECT_EQ(complaint(baseline_m), "accepted");
    const std::string mm = complaint(1000.0 * baseline_m), cm = complaint(100.0 * baseline_m);
    EXPECT_TRUE(names(mm, "0.01 to 2 m")) << mm;
    EXPECT_TRUE(names(mm, "in mm (" + std::to_string(baseline_m) + " m)")) << mm;
    EXPECT_TRUE(names(cm, "in cm (" + std::to_string(baseline_m) + " m)")) << cm;
  }
  EXPECT_TRUE(names(complaint(0.12 / 0.0254), "inches (0.12")) << complaint(0.12 / 0.0254);
  EXPECT_TRUE(names(complaint(193.001), "193.001 m")) << complaint(193.001);
  EXPECT_TRUE(names(complaint(0.00012), "baseline")) << "kilometres";
  EXPECT_TRUE(names(complaint(-0.12), "exchanged")) << complaint(-0.12);
  EXPECT_TRUE(names(complaint(0.0), "the same position")) << complaint(0.0);
  EXPECT_TRUE(names(complaint(kNaN), "baseline")) << complaint(kNaN);
}

TEST(StereoGeometry, RefusesACalibrationOfAnotherImageSizeAndNamesTheSize) {
  for (const double factor : {1.2, 4.0 / 3.0, 1.5, 2.0, 0.75, 0.5}) {
    for (const double cy_px : {0.47 * 480, 0.53 * 480}) {  // as far down as rectification moves it
      const std::string text = message([&](auto& c) {
        c.fx_px = c.fy_px = factor * c.fx_px;
        c.cx_px = c.cx_right_px = factor * 320.0;
        c.cy_px = factor * cy_px;
      });
      EXPECT_NE(text.find("far from the middle of 640 x 480 px: the calibration is likely of"), text.npos) << factor;
    }
  }
  const std::string exact = message([](auto& c) {
    c.cx_px = c.cx_right_px = 480.0;
    c.cy_px = 360.0;
  });
  EXPECT_NE(exact.find("(480, 360)"), exact.npos) << exact;
  EXPECT_NE(exact.find("likely of 960 x 720 px"), exact.npos) << exact;
}

TEST(StereoGeometry, APrincipalPointOffAlongOneSideIsALens) {
  for (const double across : {0.44, 0.5, 0.65}) {  // as real rectified pairs have it
    for (const double down : {0.47, 0.5, 0.53}) {
      const auto moved = [&](auto& c) {
        c.cx_px = c.cx_right_px = across * 640.0;
        c.cy_px = down * 480.0;
      };
      EXPECT_EQ(message(moved), "accepted") << across << ' ' << down;
    }
  }
}

/// A calibration of which the principal point is at these shares of width and height.
StereoCalibration withPrincipalPoint(cv::Size size_px, double across, double down) {
  StereoCalibration calibration = vgaCalibration();
  calibration.size_px = size_px;
  calibration.cx_px = calibration.cx_right_px = across * size_px.width;
  calibration.cy_px = down * size_px.height;
  return calibration;
}

bool isRefused(const StereoCalibration& calibration) {
  try {
    const StereoGeometry geometry(calibration);
    return false;
  } catch (const std::invalid_argument&) {
    return true;
  }
}

TEST(StereoGeometry, RefusesTheCalibrationOfASensorForAPartOfItAndNamesThePart) {
  const auto rows = [](int height_px) { return message([&](auto& c) { c.size_px.height = height_px; }); };
  const std::string text = rows(360);  // 16:9 of 4:3
  EXPECT_NE(text.find("(319.5, 239.5) is far from the middle of 640 x 360 px"), text.npos) << text;
  EXPECT_NE(text.find("likely of 640 x 480 px, of which these images show 360 rows, e.g. 60 to 420"), text.npos)
      << text;
  EXPECT_NE(text.find("cy is at 67 % of the height, at 38 to 62 % in rectified pairs"), text.npos) << text;
  const std::string columns = message([](auto& c) { c.size_px.width = 480; });
  EXPECT_NE(columns.find("of which these images show 480 columns, e.g. 80 to 560"), columns.npos) << columns;
  EXPECT_NE(columns.find("cx is at 67 % of the width"), columns.npos) << columns;
  EXPECT_NE(message([](auto& c) { c.size_px = {640, 640}; }).find("likely of 640 x 480 px;"), text.npos) << "of a part";
  for (const int height_px : {240, 300, 380}) EXPECT_NE(rows(height_px), "accepted") << height_px;
}

TEST(StereoGeometry, DoubtsWhatFewPairsHave) {
  const auto doubts = [](double width_share, double height_share) {
    StereoCalibration calibration = vgaCalibration();
    calibration.size_px = {cvRound(width_share * 640.0), cvRound(height_share * 480.0)};
    return doubtsOf(calibration);
  };
  EXPECT_EQ(doubts(1.0, 1.0), "");
  EXPECT_NE(doubts(1.0, 0.9).find("show 432 rows, e.g. 24 to 456"), std::string::npos) << doubts(1.0, 0.9);
  for (const double share : {0.85, 0.88}) EXPECT_NE(doubts(1.0, share), "") << share;
  for (const double share : {0.8, 0.833}) EXPECT_NE(doubts(share, 1.0), "") << share;
}

TEST(StereoGeometry, ACalibrationOfAnImageALittleLargerIsDoubtedOrRefused) {
  for (const double factor : {1.08, 1.1, 1.12, 1.15, 1.18, 1.2}) {
    for (const double across : {0.495, 0.5, 0.505}) {  // as a lens is off its sensor's middle
      for (const double down : {0.495, 0.5, 0.505}) {
        const StereoCalibration calibration = withPrincipalPoint({640, 480}, factor * across, factor * down);
        const std::string doubts = doubtsOf(calibration);
        EXPECT_NE(doubts.find("is likely of "), std::string::npos) << factor << ' ' << across << ' ' << down;
        EXPECT_EQ(isRefused(calibration), std::min(factor * across, factor * down) > 0.563) << factor;
      }
    }
  }
  const std::string text = doubtsOf(withPrincipalPoint({640, 480}, 0.56, 0.56));
  EXPECT_NE(text.find("likely of 717 x 538 px"), text.npos) << text;
  EXPECT_NE(doubtsOf(withPrincipalPoint({640, 480}, 1e18, 0.5)).find("likely of 1.28e+21 x 480 px"), text.npos);
}

/// EuRoC, KITTI, ETH3D and Middlebury, rectified.
TEST(StereoGeometry, RealPairsAreNotRefusedAndHardlyDoubted) {
  struct Pair {
    cv::Size size_px;
    double cx_px, cy_px, cx_right_px;
  };
  for (const auto& [size_px, cx_px, cy_px, cx_right_px] : std::vector<Pair>{{{752, 480}, 364.4, 257.0, 364.4},
                                                                            {{1242, 375}, 609.6, 172.9, 609.6},
                                                                            {{1226, 370}, 601.9, 183.1, 601.9},
                                                                            {{942, 489}, 553.7, 232.4, 553.7},
                                                                            {{941, 490}, 542.0, 255.1, 542.0},
                                                                            {{707, 425}, 381.1, 208.2, 381.1},
                                                                            {{715, 441}, 369.7, 239.4, 369.7},
                                                                            {{741, 497}, 294.2, 252.9, 327.0},
                                                                            {{699, 476}, 323.0, 240.9, 392.8},
                                                                            {{735, 485}, 392.9, 243.2, 412.3}}) {
    StereoCalibration calibration = vgaCalibration();
    calibration.size_px = size_px;
    calibration.cx_px = cx_px;
    calibration.cy_px = cy_px;
    calibration.cx_right_px = cx_right_px;
    EXPECT_FALSE(isRefused(calibration)) << size_px;
    EXPECT_EQ(doubtsOf(calibration), "") << size_px;
  }
  const StereoCalibration one_of_eth3d = withPrincipalPoint({927, 489}, 0.562, 0.6);
  EXPECT_FALSE(isRefused(one_of_eth3d));
  EXPECT_NE(doubtsOf(one_of_eth3d), "");
}

TEST(StereoGeometry, RefusesEachImpossibleNumberByName) {
  EXPECT_NE(message([](auto& c) { c.baseline_m = 0.0; }).find("baseline"), std::string::npos);
  EXPECT_NE(message([](auto& c) { c.fx_px = -350.0; }).find("fx"), std::string::npos);
  EXPECT_NE(message([](auto& c) { c.fy_px = kNaN; }).find("fy"), std::string::npos);
  EXPECT_NE(message([](auto& c) { c.size_px = {}; }).find("width"), std::string::npos);
  EXPECT_NE(message([](auto& c) { c.size_px = {640, 1}; }).find("2 or more (640 x 1)"), std::string::npos);
  EXPECT_NE(message([](auto& c) { c.cx_right_px = kInfinity; }).find("right cx"), std::string::npos);
}

}  // namespace
}  // namespace flight_corridor
