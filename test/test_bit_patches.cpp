#include <gtest/gtest.h>

#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "flight_corridor/corridor/bit_patches.hpp"

namespace flight_corridor {
namespace {

constexpr int kRows = 40, kWords = 3, kStep = 5;

/// Of the patches' pixels, 255.
cv::Mat found(const cv::Mat& pixels, double smallest_px) {
  std::vector<std::uint64_t> bits(kRows * kStep, 0);
  for (int v = 0; v < pixels.rows; ++v) {
    for (int u = 0; u < pixels.cols; ++u) {
      if (pixels.at<std::uint8_t>(v, u)) bits[v * kStep + u / 64] |= std::uint64_t{1} << u % 64;
    }
  }
  cv::Mat found = cv::Mat::zeros(pixels.size(), CV_8UC1);
  BitPatches patches;
  for (const BitPatches::Run& run : patches.find({bits.data(), kStep, kRows, kWords}, smallest_px)) {
    found.row(run.v).colRange(run.first_u, run.end_u).setTo(255);
  }
  return found;
}

/// By OpenCV's labels.
cv::Mat expected(const cv::Mat& pixels, int smallest_px) {
  cv::Mat labels, stats, centroids, expected = cv::Mat::zeros(pixels.size(), CV_8UC1);
  const int count = cv::connectedComponentsWithStats(pixels, labels, stats, centroids, 8);
  for (int label = 1; label < count; ++label) {
    if (stats.at<int>(label, cv::CC_STAT_AREA) >= smallest_px) expected.setTo(255, labels == label);
  }
  return expected;
}

TEST(BitPatches, AreTheComponentsThatAreLargeEnough) {
  cv::RNG random(1);
  for (int i = 0; i < 100; ++i) {
    cv::Mat pixels(kRows, 64 * kWords, CV_8UC1);
    random.fill(pixels, cv::RNG::UNIFORM, 0, 256);
    pixels = pixels < 20 + 2 * i;
    for (const int smallest_px : {1, 2, 5, 40}) {
      EXPECT_EQ(cv::countNonZero(found(pixels, smallest_px) != expected(pixels, smallest_px)), 0) << i;
    }
  }
}

TEST(BitPatches, ARunGoesOnInTheNextWord) {
  cv::Mat pixels = cv::Mat::zeros(kRows, 64 * kWords, CV_8UC1);
  pixels.row(3).setTo(255);
  EXPECT_EQ(cv::countNonZero(found(pixels, 64 * kWords)), 64 * kWords);
  EXPECT_EQ(cv::countNonZero(found(pixels, 64 * kWords + 1)), 0);
}

}  // namespace
}  // namespace flight_corridor
