#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "flight_corridor/unmatched_texture.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr float kClearTexture = 20.0f, kLeastTexture = 1.5f;
constexpr float kFar_m = 8.0f;
const StereoGeometry kGeometry(test_support::vgaCalibration());
const int kMiddle = kGeometry.size().width / 2;  // the optical axis, in the middle of each cross-section

/// 1.2 m wide, 0.4 m high, 4 m long, from the camera along its axis.
Box corridor() {
  Box box;
  box.T_M_F = opticalFromForward();
  box.size_m = {4.0, 1.2, 0.4};
  return box;
}

cv::Mat wall() { return {kGeometry.size(), CV_32FC1, cv::Scalar(kFar_m)}; }

/// A wall far away with a gap across all rows.
cv::Mat wallWithGap(int first, int width) {
  cv::Mat depth_m = wall();
  depth_m.colRange(first, first + width).setTo(kNothing);
  return depth_m;
}

Disparity evenTexture(float texture) {
  Disparity disparity;
  disparity.texture.create(kGeometry.size(), CV_32FC1);
  disparity.texture.setTo(texture);
  disparity.least_texture = kLeastTexture;
  return disparity;
}

/// Noise that fits on itself at one disparity alone.
StereoFrame pairWithDisparity(int disparity_px) {
  StereoFrame pair;
  pair.left.create(kGeometry.size(), CV_8UC1);
  cv::RNG(7).fill(pair.left, cv::RNG::UNIFORM, 0, 256);
  pair.right.create(kGeometry.size(), CV_8UC1);
  cv::RNG(8).fill(pair.right, cv::RNG::UNIFORM, 0, 256);
  const int width = pair.left.cols - disparity_px;
  pair.left.colRange(disparity_px, pair.left.cols).copyTo(pair.right.colRange(0, width));
  return pair;
}

const int kInTheBox_px = static_cast<int>(std::lround(kGeometry.disparity(2.0)));
const int kBehindTheBox_px = static_cast<int>(std::lround(kGeometry.disparity(6.0)));
const int kFar_px = static_cast<int>(std::floor(kGeometry.disparity(kFar_m)));
constexpr double kNearest_m = 0.4;

double share(const cv::Mat& depth_m, const Disparity& disparity = evenTexture(kClearTexture),
             const Box& box_C = corridor(), const StereoFrame& pair = pairWithDisparity(kInTheBox_px)) {
  return UnmatchedTexture(kGeometry, pair, disparity, depth_m, kNearest_m, box_C).share();
}

DepthImages filledImages(const StereoFrame& pair, const cv::Mat& matched_m, float texture = kClearTexture,
                         double told_m = kNaN) {
  DepthImages depth{matched_m, matched_m.clone(), {}};
  UnmatchedTexture(kGeometry, pair, evenTexture(texture), matched_m, kNearest_m, corridor(), told_m).fill(depth);
  return depth;
}

/// The middle row of a depth image, filled.
cv::Mat filled(const StereoFrame& pair, const cv::Mat& matched_m, float texture = kClearTexture, double told_m = kNaN) {
  return filledImages(pair, matched_m, texture, told_m).filled_m.row(kGeometry.size().height / 2);
}

int widthAtTheEnd() {
  const double left = kGeometry.project({-0.6, 0.0, 4.0}).x(), right = kGeometry.project({0.6, 0.0, 4.0}).x();
  return static_cast<int>(right) - static_cast<int>(left);
}

TEST(UnmatchedTexture, IsTheGapsShareOfTheViewWhereItIsLargest) {
  EXPECT_EQ(share(wall()), 0.0);
  EXPECT_NEAR(share(wallWithGap(kMiddle, 12)), 12.0 / widthAtTheEnd(), 1e-6);
}

TEST(UnmatchedTexture, ItsImageShowsTheGapInTheViews) {
  const StereoFrame pair = pairWithDisparity(kInTheBox_px);
  const Disparity disparity = evenTexture(kClearTexture);
  const cv::Mat depth_m = wallWithGap(kMiddle, 12);
  const cv::Mat image = UnmatchedTexture(kGeometry, pair, disparity, depth_m, kNearest_m, corridor()).image();
  const int row = kGeometry.size().height / 2;
  ASSERT_EQ(image.size(), kGeometry.size());
  EXPECT_EQ(cv::countNonZero(image.row(row) == kClearTexture), 12);
  EXPECT_EQ(cv::countNonZero(image.row(row)), 12);
  EXPECT_EQ(image.at<float>(row, kMiddle), kClearTexture);
  EXPECT_EQ(cv::countNonZero(image.row(0)), 0) << "above the corridor";
}

TEST(UnmatchedTexture, WhatWouldNotFitInTheBoxIsNoSign) {
  const StereoFrame behind = pairWithDisparity(kBehindTheBox_px);
  EXPECT_EQ(share(wallWithGap(kMiddle, 12), evenTexture(kClearTexture), corridor(), behind), 0.0);
}

TEST(UnmatchedTexture, WhatFitsOnASurfaceBesideItAndBehindTheBoxTooIsNoSign) {
  constexpr int kGap_px = 12;
  StereoFrame pair = pairWithDisparity(kInTheBox_px);
  const cv::Range gap(kMiddle - 2, kMiddle + kGap_px + 2);  // with what its windows reach
  pair.left.colRange(gap).copyTo(pair.right.colRange(gap.start - kFar_px, gap.end - kFar_px));
  const cv::Mat depth_m = wallWithGap(kMiddle, kGap_px);
  EXPECT_EQ(share(depth_m, evenTexture(kClearTexture), corridor(), pair), 0.0);

  cv::Mat nearer_m = depth_m.clone();  // the surface beside it is another one
  nearer_m.setTo(5.0f, nearer_m == kFar_m);
  EXPECT_GT(share(nearer_m, evenTexture(kClearTexture), corridor(), pair), 0.0);
  cv::Mat within_m = depth_m.clone();
  within_m.setTo(kGeometry.depth(kInTheBox_px), within_m == kFar_m);
  EXPECT_GT(share(within_m, evenTexture(kClearTexture), corridor(), pair), 0.0) << "it fits on one in the box";
}

TEST(UnmatchedTexture, WhatFitsOnTheSurfaceAroundItBehindTheBoxFillsIt) {
  const cv::Mat matched_m = wallWithGap(kMiddle, 12);
  EXPECT_EQ(cv::countNonZero(filled(pairWithDisparity(kFar_px), matched_m) == kFar_m), kGeometry.size().width);
  EXPECT_EQ(cv::countNonZero(filled(pairWithDisparity(kFar_px), matched_m, 1.1f * kLeastTexture) == kFar_m),
            kGeometry.size().width)
      << "little texture is enough";
  for (const int other_px : {kInTheBox_px, kBehindTheBox_px}) {
    const cv::Mat depth_m = filled(pairWithDisparity(other_px), matched_m);
    EXPECT_EQ(cv::countNonZero(depth_m == kFar_m), kGeometry.size().width - 12) << other_px;
  }
  EXPECT_EQ(cv::countNonZero(filled(pairWithDisparity(kFar_px), matched_m, 0.9f * kLeastTexture) == kFar_m),
            kGeometry.size().width - 12)
      << "none is not";
}

TEST(UnmatchedTexture, LittleTextureFitsThoughNoiseTakesFromItsCorrelation) {
  const auto filledOf12 = [](double noise_grey, float texture) {
    StereoFrame pair = pairWithDisparity(kFar_px);
    cv::Mat noise(pair.right.size(), CV_16SC1), noisy;
    cv::RNG(9).fill(noise, cv::RNG::UNIFORM, -noise_grey, noise_grey);
    cv::add(pair.right, noise, noisy, cv::noArray(), CV_8U);
    pair.right = noisy;
    const cv::Mat depth_m = filled(pair, wallWithGap(kMiddle, 12), texture);
    return cv::countNonZero(depth_m == kFar_m) - (kGeometry.size().width - 12);
  };
  constexpr float kFaintTexture = 1.1f * kLeastTexture;
  EXPECT_EQ(filledOf12(60.0, kFaintTexture), 12);
  EXPECT_EQ(filledOf12(130.0, kFaintTexture), filledOf12(130.0, kClearTexture) + 12)
      << "clear texture should fit better";
  EXPECT_EQ(filledOf12(255.0, kFaintTexture), 0);
}

TEST(UnmatchedTexture, ClearTextureThatFitsBehindTheBoxIsBackgroundEvenIfItFitsBetterInIt) {
  const cv::Mat matched_m = wallWithGap(kMiddle, 12);
  const int row = kGeometry.size().height / 2;
  const auto width = [&](const StereoFrame& pair, float texture) {
    const cv::Mat background = filledImages(pair, matched_m, texture).background;
    EXPECT_EQ(cv::countNonZero(background.row(0)), 0) << "above the corridor";
    return cv::countNonZero(background.row(row) == 255);
  };
  EXPECT_EQ(width(pairWithDisparity(kFar_px), kClearTexture), 12);
  EXPECT_EQ(width(pairWithDisparity(kFar_px), 1.1f * kLeastTexture), 0) << "little texture fits by chance";
  EXPECT_EQ(width(pairWithDisparity(kInTheBox_px), kClearTexture), 0);
  StereoFrame both = pairWithDisparity(kFar_px);
  const cv::Range gap(kMiddle - 6, kMiddle + 18);  // with what its windows reach
  both.left.colRange(gap).copyTo(both.right.colRange(gap.start - kInTheBox_px, gap.end - kInTheBox_px));
  cv::Mat noise(both.left.rows, gap.size(), CV_16SC1), noisy;
  cv::RNG(9).fill(noise, cv::RNG::UNIFORM, -40, 40);
  cv::add(both.left.colRange(gap), noise, noisy, cv::noArray(), CV_8U);
  noisy.copyTo(both.right.colRange(gap.start - kFar_px, gap.end - kFar_px));
  EXPECT_LT(cv::countNonZero(filled(both, matched_m) == kFar_m), kGeometry.size().width) << "it fits better in the box";
  EXPECT_EQ(width(both, kClearTexture), 12);
}

TEST(UnmatchedTexture, WhatHasADepthKeepsIt) {
  const cv::Mat matched_m = wallWithGap(kMiddle, 12);
  DepthImages depth{matched_m, matched_m.clone(), {}};
  depth.filled_m.colRange(kMiddle, kMiddle + 3).setTo(5.0f);
  UnmatchedTexture(kGeometry, pairWithDisparity(kFar_px), evenTexture(kClearTexture), matched_m, kNearest_m, corridor())
      .fill(depth);
  const cv::Mat row = depth.filled_m.row(kGeometry.size().height / 2);
  EXPECT_EQ(cv::countNonZero(row == 5.0f), 3);
  EXPECT_EQ(cv::countNonZero(row == kFar_m), row.cols - 3);
}

TEST(UnmatchedTexture, WhatFitsBetterInTheBoxFillsNothingButALittleBetterWhereTheLidarTellsOfTheOtherSurface) {
  const cv::Range gap(kMiddle, kMiddle + 8), windows(kMiddle - 4, kMiddle + 12);
  const auto with = [&](int exact_px, int noisy_px, double told_m = kNaN, double noise_grey = 40.0) {
    // the gap's content twice on the right image
    StereoFrame pair = pairWithDisparity(exact_px);
    cv::Mat noise(pair.left.rows, windows.size(), CV_16SC1), noisy;
    cv::RNG(9).fill(noise, cv::RNG::UNIFORM, -noise_grey, noise_grey);
    cv::add(pair.left.colRange(windows), noise, noisy, cv::noArray(), CV_8U);
    noisy.copyTo(pair.right.colRange(windows.start - noisy_px, windows.end - noisy_px));
    const cv::Mat matched_m = wallWithGap(gap.start, gap.size());
    return cv::countNonZero(filled(pair, matched_m, kClearTexture, told_m).colRange(gap) == kFar_m);
  };
  EXPECT_EQ(with(kFar_px, kInTheBox_px), 8);
  EXPECT_EQ(with(kInTheBox_px, kFar_px), 0);
  EXPECT_EQ(with(kInTheBox_px, kFar_px, kFar_m), 8);
  EXPECT_EQ(with(kInTheBox_px, kFar_px, 6.0), 0) << "it tells of something else";
  EXPECT_LT(with(kInTheBox_px, kFar_px, kFar_m, 80.0), 8) << "some of them much better";
}

TEST(UnmatchedTexture, BesideAnEdgeWindowsThatShowOneSurfaceDecide) {
  StereoFrame pair = pairWithDisparity(kFar_px);
  cv::Mat other = pair.right.colRange(kMiddle - kFar_px, pair.right.cols);  // right of the edge nothing fits
  cv::RNG(9).fill(other, cv::RNG::UNIFORM, 0, 256);
  const cv::Mat gap_m = filled(pair, wallWithGap(kMiddle - 6, 12)).colRange(kMiddle - 6, kMiddle + 6);
  EXPECT_EQ(cv::countNonZero(gap_m.colRange(0, 6) == kFar_m), 6) << "up to the edge";
  EXPECT_EQ(cv::countNonZero(gap_m.colRange(7, 12) == kFar_m), 0) << "a pixel beyond at the most";
}

TEST(UnmatchedTexture, TwoOfTheMatchesToEightSidesAreEnoughOneIsNot) {
  const StereoFrame pair = pairWithDisparity(kFar_px);
  const int row = kGeometry.size().height / 2;
  cv::Mat matched_m(kGeometry.size(), CV_32FC1, cv::Scalar(kNothing));
  matched_m.at<float>(row - 10, kMiddle - 10) = kFar_m;
  EXPECT_TRUE(std::isnan(filled(pair, matched_m).at<float>(kMiddle)));
  matched_m.at<float>(row + 10, kMiddle - 10) = kFar_m;
  EXPECT_EQ(filled(pair, matched_m).at<float>(kMiddle), kFar_m);
}

TEST(UnmatchedTexture, FitsWhateverTheExposures) {
  StereoFrame pair = pairWithDisparity(kInTheBox_px);
  pair.right.convertTo(pair.right, -1, 0.5, 40.0);
  EXPECT_NEAR(share(wallWithGap(kMiddle, 12), evenTexture(kClearTexture), corridor(), pair), 12.0 / widthAtTheEnd(),
              1e-6);
}

TEST(UnmatchedTexture, OutsideOfTheBoxsViewDoesNotCount) {
  Box low = corridor();
  low.T_M_F.translation().y() = 1.0;  // down
  cv::Mat depth_m = wall();
  depth_m(cv::Rect(kMiddle, 0, 12, kGeometry.size().height / 2)).setTo(kNothing);
  EXPECT_GT(share(depth_m), 0.0);
  EXPECT_EQ(share(depth_m, evenTexture(kClearTexture), low), 0.0);
}

TEST(UnmatchedTexture, GapsWithoutClearTextureAreNoSign) {
  EXPECT_EQ(share(wallWithGap(kMiddle, 12), evenTexture(2.0f * kLeastTexture)), 0.0);
}

TEST(UnmatchedTexture, WeighsByTexture) {
  Disparity disparity = evenTexture(kClearTexture);
  disparity.texture.colRange(kMiddle, kMiddle + 12).setTo(3.0f * kClearTexture);
  const double matched = widthAtTheEnd() - 12.0;
  EXPECT_NEAR(share(wallWithGap(kMiddle, 12), disparity), 36.0 / (matched + 36.0), 1e-6);
}

TEST(UnmatchedTexture, WhatANearerSurfaceHidesFromTheRightCameraIsNoSign) {
  const float near_m = 2.5f;
  const auto hidden_px = static_cast<int>(kGeometry.disparity(near_m) - kGeometry.disparity(kFar_m));
  cv::Mat depth_m = wallWithGap(kMiddle, hidden_px);
  EXPECT_GT(share(depth_m), 0.0) << "nothing nearer";
  depth_m.colRange(kMiddle + hidden_px, depth_m.cols).setTo(near_m);
  EXPECT_EQ(share(depth_m), 0.0);
  depth_m.colRange(kMiddle - 8, kMiddle).setTo(near_m);
  EXPECT_EQ(share(depth_m), 0.0) << "the background shows a little farther beside";
  depth_m.colRange(kMiddle - hidden_px, kMiddle).setTo(kNothing);
  EXPECT_GT(share(depth_m), 0.0) << "twice as wide as it hides";
}

TEST(UnmatchedTexture, WhatLiesBesideTheRightImageIsNoSign) {
  Box left = corridor();
  left.T_M_F.translation().x() = kGeometry.point(kInTheBox_px + 30, 0, 4.0).x();
  const auto hidden_px = static_cast<int>(kGeometry.disparity(kFar_m));
  EXPECT_EQ(share(wallWithGap(0, hidden_px), evenTexture(kClearTexture), left), 0.0);
  EXPECT_GT(share(wallWithGap(0, kInTheBox_px + 30), evenTexture(kClearTexture), left), 0.0) << "wider than that";
}

TEST(UnmatchedTexture, GapsFromBorderToBorderCount) { EXPECT_GT(share(wallWithGap(0, kGeometry.size().width)), 0.5); }

TEST(UnmatchedTexture, NearPartsOfTheBoxAreLookedAt) {
  const int first = static_cast<int>(kGeometry.project({0.45, 0.0, 0.8}).x());  // not in view of the box's end
  ASSERT_GT(first, kGeometry.project({0.6, 0.0, 4.0}).x());
  EXPECT_GT(share(wallWithGap(first, 40)), 0.05);
}

TEST(UnmatchedTexture, WindowsAreFoundBesideDifferentPrincipalPoints) {
  StereoCalibration calibration = test_support::vgaCalibration();
  constexpr int kDifference_px = 30;
  calibration.cx_right_px = calibration.cx_px - kDifference_px;
  const StereoGeometry geometry(calibration);
  const auto share = [&](int disparity_px) {
    return UnmatchedTexture(geometry, pairWithDisparity(disparity_px), evenTexture(kClearTexture),
                            wallWithGap(kMiddle, 12), kNearest_m, corridor())
        .share();
  };
  EXPECT_GT(share(kInTheBox_px + kDifference_px), 0.0);
  EXPECT_EQ(share(kBehindTheBox_px + kDifference_px), 0.0);
}

TEST(UnmatchedTexture, ABoxThatIsNotInViewHasNone) {
  Box behind = corridor();
  behind.T_M_F.translation().z() = -9.0;
  EXPECT_EQ(share(wallWithGap(kMiddle, 12), evenTexture(kClearTexture), behind), 0.0);
}

TEST(UnmatchedTexture, OfABoxThatReachesBehindTheCameraAllOfTheImageIsLookedAt) {
  Box across;  // its axis points to the right
  across.T_M_F.translation() = Eigen::Vector3d(-0.6, 0.0, 1.9);
  across.size_m = {1.2, 0.4, 4.0};
  EXPECT_NEAR(share(wallWithGap(kMiddle, 64), evenTexture(kClearTexture), across), 0.1, 0.01);
}

TEST(UnmatchedTexture, BlankImagesHaveNone) { EXPECT_EQ(share(wallWithGap(kMiddle, 12), evenTexture(0.0f)), 0.0); }

}  // namespace
}  // namespace flight_corridor
