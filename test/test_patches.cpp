#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "flight_corridor/stereo/patches.hpp"
#include "support/calibrations.hpp"
#include "support/corridor_box.hpp"

namespace flight_corridor {
namespace {

using test_support::kSmallest_m;
using test_support::kSmallGeometry;

cv::Mat nothing() { return {kSmallGeometry.size(), CV_32FC1, cv::Scalar(kNaN)}; }

int matches(const cv::Mat& disparity_px) { return cv::countNonZero(disparity_px > 0.0); }

int kept(cv::Mat disparity_px, double smallest_m = kSmallest_m) {
  cv::Mat repeated_px = nothing();
  BandWorkers workers(2);
  const int kept = Patches(kSmallGeometry, smallest_m, workers).keep(disparity_px, repeated_px);
  EXPECT_EQ(kept, matches(disparity_px));
  return kept;
}

/// What a pixel counts: an outline, 9 px wide, is as wide as the smallest obstacle.
double pixelArea(double disparity_px) {
  const double edge_m = kSmallGeometry.calibration().baseline_m / disparity_px;
  return edge_m * std::max(edge_m, kSmallest_m / 9.0);
}

/// Pixels that the smallest obstacle shows at a disparity.
double enough(double disparity_px) { return kSmallest_m * kSmallest_m / pixelArea(disparity_px); }

TEST(Patches, APatchAsLargeAsTheSmallestObstacleOrItsOutlineStaysAtEveryDistance) {
  for (const double disparity_px : {4.0, 12.0, 40.0}) {
    const int least = static_cast<int>(std::ceil(enough(disparity_px)));
    ASSERT_LT(least, 310);
    for (const int pixels : {least - 1, least}) {
      cv::Mat disparity = nothing();
      disparity(cv::Rect(3, 7, pixels, 1)).setTo(disparity_px);
      EXPECT_EQ(kept(disparity), pixels < least ? 0 : pixels) << disparity_px << " px";
    }
  }
}

TEST(Patches, NeighboursDifferByAPixelAtMost) {
  const int rows = static_cast<int>(enough(12.0) / 10.0) + 2;
  for (const double step_px : {1.0, 1.1}) {
    cv::Mat disparity = nothing();  // each column alone is too small
    for (int u = 0; u < 10; ++u) disparity(cv::Rect(50 + u, 20, 1, rows)).setTo(12.0 + step_px * (u % 2));
    EXPECT_EQ(kept(disparity), step_px > 1.0 ? 0 : 10 * rows);
  }
}

TEST(Patches, APatchMostOfWhichIsRepeatedIsRepeatedAsAWhole) {
  for (const int repeated_rows : {40, 60}) {
    cv::Mat best = nothing(), repeated = nothing();
    best(cv::Rect(50, 20, 30, 100)).setTo(12.0);
    const cv::Rect rows(50, 20, 30, repeated_rows);
    best(rows).copyTo(repeated(rows));
    best(rows).setTo(kNaN);
    BandWorkers workers(2);
    Patches(kSmallGeometry, kSmallest_m, workers).keep(best, repeated);
    EXPECT_EQ(matches(best), repeated_rows > 50 ? 0 : 30 * (100 - repeated_rows));
    EXPECT_EQ(matches(repeated), 30 * (repeated_rows > 50 ? 100 : repeated_rows));
  }
}

TEST(Patches, AnIslandOnASurfaceGoesTheSurfaceStays) {
  cv::Mat disparity(kSmallGeometry.size(), CV_32FC1, cv::Scalar(5.0));
  disparity(cv::Rect(100, 100, 4, 4)).setTo(30.0);
  EXPECT_EQ(kept(disparity), disparity.rows * disparity.cols - 16);
}

TEST(Patches, ALoopThatClosesLateIsOnePatch) {
  const int side = static_cast<int>(enough(12.0) / 3.0) + 1;
  cv::Mat disparity = nothing();
  disparity(cv::Rect(10, 10, 1, side)).setTo(12.0);
  disparity(cv::Rect(20, 10, 1, side)).setTo(12.0);
  EXPECT_EQ(kept(disparity.clone()), 0);
  disparity(cv::Rect(10, 9 + side, 11, 1)).setTo(12.0);
  const int pixels = matches(disparity);
  ASSERT_GE(pixels, enough(12.0) - 1.0);
  disparity(cv::Rect(11, 8 + side, 9, 1)).setTo(12.0);
  EXPECT_EQ(kept(disparity), pixels + 9);
}

TEST(Patches, WithoutASmallestObstacleAllStay) {
  cv::Mat disparity = nothing();
  disparity.at<float>(5, 5) = 3.0f;
  EXPECT_EQ(kept(disparity, 0.0), 1);
}

/// The same by flooding, pixel by pixel.
cv::Mat flooded(const cv::Mat& disparity_px) {
  cv::Mat result = disparity_px.clone(), seen = cv::Mat::zeros(disparity_px.size(), CV_8UC1);
  for (int first = 0; first < static_cast<int>(disparity_px.total()); ++first) {
    std::vector<int> patch{first};
    if (seen.data[first] || !(disparity_px.ptr<float>()[first] > 0.0f)) continue;
    seen.data[first] = 1;
    double area_m2 = 0.0;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const float d = disparity_px.ptr<float>()[patch[i]];
      const int u = patch[i] % disparity_px.cols, v = patch[i] / disparity_px.cols;
      area_m2 += pixelArea(d);
      for (const auto& [du, dv] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1),
                                   std::pair(1, 1), std::pair(-1, 1), std::pair(1, -1), std::pair(-1, -1)}) {
        if (u + du < 0 || u + du >= disparity_px.cols || v + dv < 0 || v + dv >= disparity_px.rows) continue;
        const int other = (v + dv) * disparity_px.cols + u + du;
        if (seen.data[other] || !(std::abs(disparity_px.ptr<float>()[other] - d) <= 1.0f)) continue;
        seen.data[other] = 1;
        patch.push_back(other);
      }
    }
    if (area_m2 >= kSmallest_m * kSmallest_m) continue;
    for (const int pixel : patch) result.ptr<float>()[pixel] = NAN;
  }
  return result;
}

TEST(Patches, RandomImagesAreAsFloodingSays) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 8; ++trial) {
    cv::Mat disparity_px(kSmallGeometry.size(), CV_32FC1);
    std::uniform_real_distribution<float> level(2.0f, 2.0f + static_cast<float>(trial)), unit(0.0f, 1.0f);
    for (auto pixel = disparity_px.begin<float>(); pixel != disparity_px.end<float>(); ++pixel) {
      *pixel = unit(random) < 0.3f ? NAN : level(random);
    }
    const cv::Mat expected = flooded(disparity_px);
    cv::Mat repeated_px = nothing();
    BandWorkers workers(2);
    Patches(kSmallGeometry, kSmallest_m, workers).keep(disparity_px, repeated_px);
    EXPECT_EQ(cv::countNonZero((disparity_px > 0.0) != (expected > 0.0)), 0) << trial;
  }
}

}  // namespace
}  // namespace flight_corridor
