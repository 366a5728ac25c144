#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "flight_corridor/stereo/free_matcher.hpp"
#include "support/calibrations.hpp"
#include "support/wall_scene.hpp"

namespace flight_corridor {
namespace {

using namespace test_support;

cv::Mat moved(const cv::Mat& image, double right_px, double down_px) {
  cv::Mat result;
  cv::warpAffine(image, result, cv::Matx23d(1, 0, right_px, 0, 1, down_px), image.size(), cv::INTER_LINEAR,
                 cv::BORDER_REPLICATE);
  return result;
}

/// Grain of a few pixels, as a camera shows it.
cv::Mat texture(cv::Size size_px, std::uint64_t seed = 1) {
  cv::Mat grain(size_px, CV_8UC1);
  cv::RNG random(seed);
  random.fill(grain, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(grain, grain, {0, 0}, 2.0);
  cv::normalize(grain, grain, 20, 230, cv::NORM_MINMAX);
  return grain;
}

TEST(FreeMatcher, FindsCornersMovedAcrossAndDown) {
  FreeMatcher matcher;
  for (const cv::Size size_px : {cv::Size(160, 120), cv::Size(320, 240), cv::Size(640, 480), cv::Size(1280, 720)}) {
    const cv::Mat image = texture(size_px);
    for (const cv::Vec2d& by_px : {cv::Vec2d(0, 0), cv::Vec2d(-10, 0), cv::Vec2d(-12.4, 3.3), cv::Vec2d(-5, -4.6)}) {
      const auto& matches = matcher.match(image, moved(image, by_px[0], by_px[1]));
      EXPECT_GT(matches.size(), 40u) << size_px << by_px;
      const auto is_wrong = [&](const FreeMatch& match) {
        const cv::Point2d off_px(match.to_px.x - match.from_px.x - by_px[0],
                                 match.to_px.y - match.from_px.y - by_px[1]);
        return cv::norm(off_px) > 0.5;  // Lucas-Kanade on an image of a third of the size
      };
      EXPECT_LE(20 * std::count_if(matches.begin(), matches.end(), is_wrong), static_cast<int>(matches.size()));
    }
  }
}

TEST(FreeMatcher, AnotherExposureChangesNothing) {
  const cv::Mat image = texture({640, 480});
  const auto& matches = FreeMatcher().match(image, 0.5 * moved(image, -8.0, 2.0) + 30.0);
  EXPECT_GT(matches.size(), 40u);
}

TEST(FreeMatcher, FindsNothingWithoutTextureOrInAnotherScene) {
  FreeMatcher matcher;
  const cv::Size size_px(640, 480);
  EXPECT_TRUE(matcher.match(cv::Mat(size_px, CV_8UC1, 100), cv::Mat(size_px, CV_8UC1, 100)).empty());
  EXPECT_LT(matcher.match(texture(size_px, 1), texture(size_px, 2)).size(), 10u);
  EXPECT_TRUE(matcher.match(cv::Mat(4, 4, CV_8UC1, 100), cv::Mat(4, 4, CV_8UC1, 100)).empty());
}

TEST(FreeMatcher, APatternThatRepeatsItselfDownwardsIsNoEvidence) {
  cv::Mat lines(480, 640, CV_8UC1);
  for (int v = 0; v < lines.rows; ++v) lines.row(v) = 120.0 + 90.0 * std::sin(v * 2.0 * CV_PI / 16.0);
  EXPECT_TRUE(FreeMatcher().match(lines, lines).empty());
}

/// A rectified image that shows all pixels is black beyond its border, and there each image has its own corners.
TEST(FreeMatcher, TheBorderOfARectifiedImageIsNoCorner) {
  cv::Mat from = texture({640, 480}), to = from.clone();
  const std::vector<cv::Point> beyond{{0, 300}, {200, 480}, {0, 480}},
      beyond_moved{{0, 280}, {200, 460}, {200, 480}, {0, 480}};
  cv::fillConvexPoly(from, beyond, 0);
  cv::fillConvexPoly(to, beyond_moved, 0);
  for (const FreeMatch& match : FreeMatcher().match(from, to)) {
    EXPECT_NEAR(match.to_px.y, match.from_px.y, 0.5) << match.from_px;
  }
}

}  // namespace
}  // namespace flight_corridor
