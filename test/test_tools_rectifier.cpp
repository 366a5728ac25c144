#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "support/raw_rig.hpp"
#include "tools/rectifier.hpp"

namespace flight_corridor::tools {
namespace {

constexpr int kBorder_px = 40;  // what the raw images do not show whole

StereoCalibration idealCalibration() {
  StereoCalibration calibration;
  calibration.size_px = {320, 240};
  calibration.fx_px = calibration.fy_px = 260.0;
  calibration.cx_px = calibration.cx_right_px = 159.5;
  calibration.cy_px = 119.5;
  calibration.baseline_m = 0.12;
  return calibration;
}

/// Waves of 12 px and more, of 100 grey levels: their second derivative is 100 (2 pi / 12)^2 = 27 at most.
cv::Mat waves(double phase) {
  cv::Mat image(idealCalibration().size_px, CV_8UC1);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      image.at<std::uint8_t>(v, u) =
          cv::saturate_cast<std::uint8_t>(127 + 50 * std::sin(u * 0.37 + phase) + 50 * std::cos(v * 0.41 - u * 0.11));
    }
  }
  return image;
}

class RectifierTest : public testing::TestWithParam<bool> {};

/// Linear interpolation errs by an eighth of the second derivative, 3.4; the maps by 1/32 px of a slope of 50 * 0.41,
/// 0.7; rounding twice by 1; the way there (cubic) by less than that.
TEST_P(RectifierTest, GivesBackTheImagesOfWhichTheRawOnesWereMade) {
  const auto cameras = test_support::makeRawRig(idealCalibration(), GetParam()).cameras;
  const Rectifier rectifier(cameras);
  const cv::Rect inner(kBorder_px, kBorder_px, 320 - 2 * kBorder_px, 240 - 2 * kBorder_px);
  for (const bool is_left : {true, false}) {
    const cv::Mat clean = waves(is_left ? 0.0 : 1.0);
    const cv::Mat raw = test_support::toRaw(is_left ? cameras.left : cameras.right, clean);
    const cv::Mat back = is_left ? rectifier.left(raw) : rectifier.right(raw);
    EXPECT_LT(cv::norm(back(inner), clean(inner), cv::NORM_INF), 6.0);
    EXPECT_GT(cv::norm(raw(inner), clean(inner), cv::NORM_INF), 50.0) << "the lens must be seen";
  }
}

INSTANTIATE_TEST_SUITE_P(Lenses, RectifierTest, testing::Bool());

TEST(Rectifier, OfRectifiedCamerasChangesNothing) {
  const Rectifier rectifier(camerasOf(idealCalibration()));
  EXPECT_EQ(cv::norm(rectifier.left(waves(0.0)), waves(0.0), cv::NORM_INF), 0.0);
}

TEST(Rectifier, NamesAnImageOfAnotherSize) {
  const Rectifier rectifier(camerasOf(idealCalibration()));
  EXPECT_THROW(rectifier.left(cv::Mat(240, 319, CV_8UC1)), std::invalid_argument);
}

}  // namespace
}  // namespace flight_corridor::tools
