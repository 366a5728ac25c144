#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "flight_corridor/range/beam_footprint.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

constexpr double kMatchSigma_px = 0.1;

using test_support::kVgaGeometry;

Eigen::Isometry3d besideTheCamera() {
  Eigen::Isometry3d T_C_L = opticalFromForward();
  T_C_L.translation() = Eigen::Vector3d(0.05, 0.06, -0.10);
  return T_C_L;
}

cv::Mat wallDisparity(double depth_m) {
  return cv::Mat(kVgaGeometry.size(), CV_32FC1, cv::Scalar(kVgaGeometry.disparity(depth_m)));
}

TEST(BeamFootprint, ThePixelMovesWithRangeTowardsTheVanishingPoint) {
  const BeamFootprint beam(LidarConfig(), kVgaGeometry, besideTheCamera(), kMatchSigma_px);
  const Eigen::Vector2d principal(319.5, 239.5);
  const double near = (beam.at(1.0, 0.02)->centre_px - principal).norm();
  const double far = (beam.at(8.0, 0.02)->centre_px - principal).norm();
  EXPECT_GT(near, 8 * far);  // parallel beam: offset shrinks as 1/Z, Z = range - 0.1
}

TEST(BeamFootprint, DepthUndoesRange) {
  Eigen::Isometry3d T_C_L = besideTheCamera();
  T_C_L.rotate(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()));
  const BeamFootprint beam(LidarConfig(), kVgaGeometry, T_C_L, kMatchSigma_px);
  for (const double range : {0.5, 2.0, 7.0}) EXPECT_NEAR(beam.range(beam.depth(range)), range, 1e-12);
}

TEST(BeamFootprint, ReadsTheWallsRangeFromAnyGuess) {
  BeamFootprint beam(LidarConfig(), kVgaGeometry, besideTheCamera(), kMatchSigma_px);
  for (const double guess : {kNaN, 0.6, 3.1, 50.0}) {
    const auto reading = beam.read(wallDisparity(3.0), guess, 0.04);
    ASSERT_TRUE(reading) << guess;
    EXPECT_NEAR(reading->range_m, 3.1, 1e-4);  // depth 3 m seen from 0.1 m behind; CV_32F
    EXPECT_NEAR(reading->disparity_sigma_px, 0.0, 1e-6);
  }
}

TEST(BeamFootprint, AMedianWithstandsOutliers) {
  BeamFootprint beam(LidarConfig(), kVgaGeometry, besideTheCamera(), kMatchSigma_px);
  cv::Mat disparity = wallDisparity(3.0);
  for (int v = 0; v < disparity.rows; v += 3) disparity.row(v).setTo(100.0);
  const auto reading = beam.read(disparity, 3.0, 0.1);
  ASSERT_TRUE(reading);
  EXPECT_NEAR(reading->range_m, 3.1, 1e-4);
}

TEST(BeamFootprint, GivesWhatIsMatchedBesideTheBeam) {
  BeamFootprint beam(LidarConfig(), kVgaGeometry, besideTheCamera(), kMatchSigma_px);
  const double radius_px = beam.at(3.0, 0.04)->radius_px;
  const auto all = static_cast<double>(beam.matchesBeside(wallDisparity(3.0), 3.0, 0.04).size());
  EXPECT_NEAR(all, 9.0 * M_PI * radius_px * radius_px, 0.02 * all);
  const auto everyRow = [&](int step) {
    cv::Mat disparity = wallDisparity(3.0);
    for (int v = 0; v < disparity.rows; ++v) {
      if (v % step) disparity.row(v).setTo(kNaN);
    }
    return static_cast<double>(beam.matchesBeside(disparity, 3.0, 0.04).size());
  };
  EXPECT_NEAR(everyRow(2), all / 2.0, 0.05 * all);
  EXPECT_EQ(everyRow(10), 0.0) << "too few to know";
  EXPECT_TRUE(beam.matchesBeside(wallDisparity(3.0), 0.1, 0.04).empty()) << "not in view";
}

TEST(BeamFootprint, WithoutEnoughMatchesThereIsNoReading) {
  BeamFootprint beam(LidarConfig(), kVgaGeometry, besideTheCamera(), kMatchSigma_px);
  EXPECT_FALSE(beam.read(cv::Mat(kVgaGeometry.size(), CV_32FC1, cv::Scalar(kNaN)), 3.0, 0.04));
}

TEST(BeamFootprint, TwoSurfacesWidenTheSpread) {
  BeamFootprint beam(LidarConfig(), kVgaGeometry, opticalFromForward(), kMatchSigma_px);
  cv::Mat disparity = wallDisparity(6.0);
  disparity.colRange(0, 321).setTo(kVgaGeometry.disparity(3.0));
  const auto reading = beam.read(disparity, 3.0, 0.1);
  ASSERT_TRUE(reading);
  disparity = wallDisparity(3.0);
  EXPECT_GE(reading->disparity_sigma_px, beam.read(disparity, 3.0, 0.1)->disparity_sigma_px);
}

TEST(BeamFootprint, ASurfaceIsOneWhereNoOtherIsAround) {
  cv::Mat disparity_px = wallDisparity(4.0);
  BeamFootprint beam(LidarConfig(), kVgaGeometry, opticalFromForward(), kMatchSigma_px);
  const auto reading = beam.read(disparity_px, kNaN, 0.0);
  ASSERT_TRUE(reading);
  EXPECT_EQ(reading->unity, 1.0);
  const int beside = static_cast<int>(reading->footprint.centre_px.x() + 2.0 * reading->footprint.radius_px);
  disparity_px.colRange(beside, disparity_px.cols).setTo(kVgaGeometry.disparity(3.0));
  const auto with_other = beam.read(disparity_px, kNaN, 0.0);
  ASSERT_TRUE(with_other);
  EXPECT_EQ(with_other->disparity_px, reading->disparity_px);
  EXPECT_LT(with_other->unity, 0.8);
}

TEST(BeamFootprint, SurfacesThatAreMetresApartFarAwayAreTwo) {
  BeamFootprint beam(LidarConfig(), kVgaGeometry, opticalFromForward(), kMatchSigma_px);
  cv::Mat disparity_px = wallDisparity(12.0);
  const auto reading = beam.read(disparity_px, kNaN, 0.0);
  ASSERT_TRUE(reading);
  const int beside = static_cast<int>(reading->footprint.centre_px.x() + 2.0 * reading->footprint.radius_px);
  ASSERT_LT(kVgaGeometry.disparity(10.0) - kVgaGeometry.disparity(12.0), 1.0);
  disparity_px.colRange(beside, disparity_px.cols).setTo(kVgaGeometry.disparity(10.0));
  const auto with_other = beam.read(disparity_px, kNaN, 0.0);
  ASSERT_TRUE(with_other);
  EXPECT_LT(with_other->unity, 0.8);
}

TEST(BeamFootprint, OutsideTheImageThereIsNoFootprint) {
  Eigen::Isometry3d T_C_L = opticalFromForward();
  T_C_L.translation().x() = 1.0;  // metres to the right: the beam enters the view only far ahead
  const BeamFootprint beam(LidarConfig(), kVgaGeometry, T_C_L, kMatchSigma_px);
  EXPECT_FALSE(beam.at(0.5, 0.02));
  EXPECT_TRUE(beam.at(5.0, 0.02));
}

TEST(BeamFootprint, ABeamEndsInViewOrElsewhere) {
  const auto endsInView = [](const Eigen::Isometry3d& T_C_L) {
    return BeamFootprint::endsInView(LidarConfig(), kVgaGeometry, T_C_L);
  };
  const auto turned = [](double down_rad) {
    return opticalFromForward() * Eigen::AngleAxisd(down_rad, Eigen::Vector3d::UnitY());
  };
  EXPECT_TRUE(endsInView(besideTheCamera()));
  EXPECT_TRUE(endsInView(Eigen::Isometry3d(turned(0.5))));  // the view ends at 34 degrees, 0.6 rad
  EXPECT_FALSE(endsInView(Eigen::Isometry3d(turned(0.7))));
  EXPECT_FALSE(endsInView(Eigen::Isometry3d(turned(M_PI_2))));
  EXPECT_FALSE(endsInView(Eigen::Isometry3d(turned(M_PI))));
  Eigen::Isometry3d nowhere = opticalFromForward();
  nowhere.translation().x() = kNaN;
  EXPECT_FALSE(endsInView(nowhere));
}

TEST(BeamFootprint, RefusesABeamThatLooksElsewhere) {
  EXPECT_TRUE(BeamFootprint::looksAhead(opticalFromForward()));
  EXPECT_THROW(BeamFootprint(LidarConfig(), kVgaGeometry, Eigen::Isometry3d::Identity(), kMatchSigma_px),
               std::invalid_argument);
  EXPECT_THROW(BeamFootprint(LidarConfig(), kVgaGeometry, opticalFromForward().inverse(), kMatchSigma_px),
               std::invalid_argument);
}

}  // namespace
}  // namespace flight_corridor
