#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "flight_corridor/level_matcher.hpp"

namespace flight_corridor {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr double kBackground_px = 4.0, kBranch_px = 11.0;

/// A textured wall and before it a dark, evenly grey branch three pixels thick that rises by slope pixels per pixel;
/// the right image is brighter by a tenth.
struct Pair {
  cv::Mat left, right, is_branch;

  /// @param blotch_px size of the wall's grain.
  /// @param branch_px the branch's disparity.
  /// @param branch_grey of 60 to 256 of the wall.
  explicit Pair(double slope, double blotch_px = 2.0, double branch_px = kBranch_px, float branch_grey = 40.0f) {
    cv::Mat texture(100, 260, CV_32FC1);
    cv::RNG random(7);
    random.fill(texture, cv::RNG::UNIFORM, 60, 256);
    cv::GaussianBlur(texture, texture, {0, 0}, blotch_px);
    cv::normalize(texture, texture, 60.0, 256.0, cv::NORM_MINMAX);
    left = seen(texture, slope, 0.0, 0.0, 1.0, branch_grey, random);
    right = seen(texture, slope, kBackground_px, branch_px, 1.1, branch_grey, random);
    is_branch = cv::Mat::zeros(left.size(), CV_8U);
    for (int u = 40; u < left.cols - 40; ++u) is_branch.at<std::uint8_t>(cvRound(row(slope, u)), u) = 255;
  }

  static double row(double slope, double u) { return 50.0 + slope * (u - 130.0); }

  static cv::Mat seen(const cv::Mat& texture, double slope, double shift_px, double branch_shift_px, double gain,
                      float branch_grey, cv::RNG& random) {
    cv::Mat image, noise(texture.size(), CV_32FC1), grey;
    const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, -shift_px, 0, 1, 0);
    cv::warpAffine(texture, image, shift, texture.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
    for (int v = 0; v < image.rows; ++v) {
      for (int u = 0; u < image.cols; ++u) {
        const double away_px = std::abs(v - row(slope, u + branch_shift_px));
        const auto share = static_cast<float>(std::clamp(2.0 - away_px, 0.0, 1.0));  // of the pixel that is branch
        float& value = image.at<float>(v, u);
        value += share * (branch_grey - value);
      }
    }
    random.fill(noise, cv::RNG::NORMAL, 0.0, 1.5);
    cv::Mat(image * gain + noise).convertTo(grey, CV_8U);
    return grey;
  }
};

/// What a matcher with much smoothing sees: the background everywhere.
cv::Mat background(const Pair& pair) { return {pair.left.size(), CV_32FC1, cv::Scalar(kBackground_px)}; }

/// @return where the disparity was set.
cv::Mat matchLevel(LevelMatcher matcher, const cv::Mat& left, const cv::Mat& right, cv::Mat& disparity_px) {
  cv::Mat level;
  matcher.match(left, right, disparity_px, level);
  return level;
}

TEST(LevelMatcher, FindsABranchThatWasGivenToItsBackground) {
  const Pair pair(0.08);
  cv::Mat disparity_px = background(pair);
  const cv::Mat level = matchLevel(LevelMatcher(-2, 128), pair.left, pair.right, disparity_px);
  const cv::Mat found = (disparity_px > kBranch_px - 1.5) & (disparity_px < kBranch_px + 1.5) & pair.is_branch;
  EXPECT_GT(cv::countNonZero(found), 0.5 * cv::countNonZero(pair.is_branch));
  EXPECT_EQ(cv::countNonZero(level != (disparity_px != kBackground_px)), 0) << "where the disparity was set";
}

TEST(LevelMatcher, FindsABranchThatIsNearlyAsGreyAsItsBackgroundByALongerWindow) {
  const Pair pair(0.12, 3.0, kBranch_px, 90.0f);
  cv::Mat disparity_px = background(pair);
  matchLevel(LevelMatcher(-2, 128), pair.left, pair.right, disparity_px);
  const cv::Mat found = (disparity_px > kBranch_px - 1.5) & (disparity_px < kBranch_px + 1.5) & pair.is_branch;
  EXPECT_GT(cv::countNonZero(found), 0.6 * cv::countNonZero(pair.is_branch));
}

TEST(LevelMatcher, AStubInLineWithAFartherRodStaysNear) {
  constexpr int kStub_px = 12, kFirst_px = 115, kLength_px = 24;
  const Pair near(0.05, 2.0, kStub_px), pair(0.05, 2.0, 9.0);
  const cv::Rect stub(kFirst_px, 0, kLength_px, pair.left.rows), in_right = stub - cv::Point(kStub_px, 0);
  near.right(in_right).copyTo(pair.right(in_right));
  cv::Mat disparity_px = background(pair);
  matchLevel(LevelMatcher(-2, 128), pair.left, pair.right, disparity_px);
  EXPECT_GT(cv::countNonZero((disparity_px(stub) > kStub_px - 1.0) & pair.is_branch(stub)), kLength_px / 2);
}

TEST(LevelMatcher, TellsFractionsOfAPixel) {
  const auto found_px = [](double branch_px) {
    const Pair pair(0.08, 2.0, branch_px);
    cv::Mat disparity_px = background(pair);
    matchLevel(LevelMatcher(-2, 128), pair.left, pair.right, disparity_px);
    const cv::Mat found = (disparity_px > branch_px - 1.5) & (disparity_px < branch_px + 1.5) & pair.is_branch;
    return cv::mean(disparity_px, found)[0];
  };
  EXPECT_NEAR(found_px(11.0) - found_px(10.7), 0.3, 0.1);
  EXPECT_NEAR(found_px(11.3) - found_px(11.0), 0.3, 0.1);
}

TEST(LevelMatcher, FindsOneThatIsAllButLevelAsTheMiddleOfAThinThingHoldsNothingOfItsBackground) {
  const Pair pair(0.035, 3.0);
  cv::Mat disparity_px = background(pair);
  matchLevel(LevelMatcher(-2, 128), pair.left, pair.right, disparity_px);
  const cv::Mat found = (disparity_px > kBranch_px - 1.5) & (disparity_px < kBranch_px + 1.5) & pair.is_branch;
  EXPECT_GT(cv::countNonZero(found), 0.5 * cv::countNonZero(pair.is_branch));
}

TEST(LevelMatcher, FindsItOnTheRowsBesideItsMiddleToo) {
  const Pair pair(0.08);
  cv::Mat disparity_px = background(pair), three_rows;
  cv::dilate(pair.is_branch, three_rows, cv::getStructuringElement(cv::MORPH_RECT, {1, 3}));
  matchLevel(LevelMatcher(-2, 128), pair.left, pair.right, disparity_px);
  EXPECT_GT(cv::countNonZero((disparity_px > kBranch_px - 1.5) & three_rows), 0.5 * cv::countNonZero(three_rows));
}

TEST(LevelMatcher, TakesAFewPixelsThatAgreeForChance) {
  const Pair pair(0.08);
  const auto found = [&](int candidates) {  // in a strip that leaves the window so many places in a row
    const cv::Range strip(100, 130 + candidates);
    cv::Mat disparity_px(pair.left.rows, strip.size(), CV_32FC1, cv::Scalar(kBackground_px));
    const cv::Mat before = disparity_px.clone();
    matchLevel(LevelMatcher(-2, 16), pair.left.colRange(strip), pair.right.colRange(strip), disparity_px);
    return cv::countNonZero(disparity_px != before);
  };
  EXPECT_EQ(found(11), 0);
  EXPECT_GT(found(60), 50);
}

TEST(LevelMatcher, FindsItAlsoWhereNothingWasMatched) {
  const Pair pair(-0.08);
  cv::Mat disparity_px(pair.left.size(), CV_32FC1, cv::Scalar(kNothing));
  matchLevel(LevelMatcher(-2, 128), pair.left, pair.right, disparity_px);
  const cv::Mat found = (disparity_px > kBranch_px - 1.5) & (disparity_px < kBranch_px + 1.5) & pair.is_branch;
  EXPECT_GT(cv::countNonZero(found), 0.5 * cv::countNonZero(pair.is_branch));
}

TEST(LevelMatcher, LeavesAPerfectlyLevelEdgeAloneSinceEveryDisparityFitsIt) {
  const Pair pair(0.0);
  cv::Mat disparity_px = background(pair);
  matchLevel(LevelMatcher(-2, 128), pair.left, pair.right, disparity_px);
  EXPECT_EQ(cv::countNonZero((disparity_px != kBackground_px) & pair.is_branch), 0);
}

TEST(LevelMatcher, LeavesWhatIsMatchedRightAlone) {
  const Pair pair(0.08);
  cv::Mat disparity_px(pair.left.size(), CV_32FC1, cv::Scalar(kBranch_px));
  const cv::Mat before = disparity_px.clone();
  matchLevel(LevelMatcher(-2, 128), pair.left, pair.right, disparity_px);
  EXPECT_EQ(cv::countNonZero((disparity_px != before) & pair.is_branch), 0);
}

TEST(LevelMatcher, LeavesAnExactRepeatAloneAlsoWithoutNoise) {
  constexpr int kPeriod_px = 16, kShift_px = 20;
  cv::Mat left(100, 260, CV_8UC1, cv::Scalar(100)), right = left.clone();
  for (int v = 49; v <= 51; ++v) {
    for (int u = 0; u < left.cols; ++u) {
      left.at<std::uint8_t>(v, u) = u % kPeriod_px < kPeriod_px / 2 ? 40 : 60;
      right.at<std::uint8_t>(v, u) = (u + kShift_px) % kPeriod_px < kPeriod_px / 2 ? 40 : 60;
    }
  }
  cv::Mat disparity_px(left.size(), CV_32FC1, cv::Scalar(kNothing));
  matchLevel(LevelMatcher(-2, 128), left, right, disparity_px);
  const cv::Mat several_fit =
      disparity_px.colRange(120, 220);  // at the margins only one of the repeats is in the image
  EXPECT_EQ(cv::countNonZero(several_fit == several_fit), 0);
}

TEST(LevelMatcher, LeavesAPlainImageAlone) {
  const cv::Mat grey(100, 260, CV_8UC1, cv::Scalar(90));
  cv::Mat disparity_px(grey.size(), CV_32FC1, cv::Scalar(kNothing));
  matchLevel(LevelMatcher(-2, 128), grey, grey, disparity_px);
  EXPECT_EQ(cv::countNonZero(disparity_px == disparity_px), 0);
}

TEST(LevelMatcher, ImagesNarrowerThanItsWindowStayAsTheyAre) {
  const cv::Mat grey(40, 20, CV_8UC1, cv::Scalar(90));
  cv::Mat disparity_px(grey.size(), CV_32FC1, cv::Scalar(3.0));
  matchLevel(LevelMatcher(-2, 32), grey, grey, disparity_px);
  EXPECT_EQ(cv::countNonZero(disparity_px != 3.0), 0);
}

}  // namespace
}  // namespace flight_corridor
