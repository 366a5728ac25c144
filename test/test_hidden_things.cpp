#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "flight_corridor/corridor.hpp"
#include "flight_corridor/hidden_things.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

const StereoGeometry kGeometry(test_support::vgaCalibration());
constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr double kWall_m = 8.0;
const cv::Point kMiddle(kGeometry.size().width / 2, kGeometry.size().height / 2);

Box corridor(double length_m = 4.0) {
  CorridorConfig config;
  config.length_m = length_m;
  return Corridor(config).box(opticalFromForward());
}

/// Pixels of a length that stands across at a depth.
int pixels(double length_m, double depth_m) {
  return static_cast<int>(std::lround(kGeometry.calibration().fx_px * length_m / depth_m));
}

/// A wall, matched and filled everywhere but in a square hole.
struct View {
  View(cv::Point middle, int size_px) : hole(middle.x - size_px / 2, middle.y - size_px / 2, size_px, size_px) {
    disparity.matched_px = cv::Mat(kGeometry.size(), CV_32FC1, cv::Scalar(kGeometry.disparity(kWall_m)));
    disparity.matched_px(hole).setTo(kNothing);
    depth.filled_m = cv::Mat(kGeometry.size(), CV_32FC1, cv::Scalar(kWall_m));
    depth.filled_m(hole).setTo(kNothing);
  }

  bool mayHide(const Box& box = corridor()) const { return mayHideThing(box, depth, disparity, kGeometry); }

  cv::Rect hole;
  DepthImages depth;
  Disparity disparity;
};

TEST(HiddenThings, AHoleAsLargeAsAThingAtTheEndMayHideIt) {
  EXPECT_TRUE(View(kMiddle, pixels(0.14, 4.0)).mayHide());
  EXPECT_FALSE(View(kMiddle, pixels(0.08, 4.0)).mayHide()) << "smaller ones are everywhere";
  EXPECT_FALSE(View(kMiddle, 0).mayHide());
}

TEST(HiddenThings, ANearerEndShowsThingsLarger) {
  EXPECT_FALSE(View(kMiddle, pixels(0.14, 4.0)).mayHide(corridor(2.0)));
  EXPECT_TRUE(View(kMiddle, pixels(0.14, 2.0)).mayHide(corridor(2.0)));
}

TEST(HiddenThings, HoweverNearTheEndAHoleOf63PixelsIsEnough) {
  for (const double end_m : {1e-2, 1e-5, 1e-10}) {  // the box stands ever more across the view
    Box across = corridor();
    across.T_M_F.rotate(Eigen::AngleAxisd(std::acos(end_m / 4.0), Eigen::Vector3d::UnitZ()));
    across.T_M_F.pretranslate(Eigen::Vector3d(2.0, 0.0, 0.0));
    EXPECT_TRUE(View(kMiddle, 70).mayHide(across)) << end_m;
    EXPECT_FALSE(View(kMiddle, 40).mayHide(across)) << end_m;
  }
  EXPECT_TRUE(View(kMiddle, 70).mayHide(corridor(0.6)));
}

TEST(HiddenThings, AHoleThatIsFilledHidesNothing) {
  View view(kMiddle, pixels(0.14, 4.0));
  view.depth.filled_m(view.hole).setTo(kWall_m);
  EXPECT_FALSE(view.mayHide());
}

TEST(HiddenThings, AHoleWhoseTextureIsOfTheBackgroundHidesNothing) {
  View view(kMiddle, pixels(0.14, 4.0));
  view.depth.background = cv::Mat::zeros(kGeometry.size(), CV_8UC1);
  EXPECT_TRUE(view.mayHide());
  view.depth.background(view.hole).colRange(0, view.hole.width / 3).setTo(255);
  EXPECT_FALSE(view.mayHide()) << "what is left is too small";
}

TEST(HiddenThings, HolesBesideANearerSurfaceAreWhatItHides) {
  View view(kMiddle, pixels(0.14, 4.0));
  view.disparity.matched_px.colRange(view.hole.br().x, view.hole.br().x + 5).setTo(kGeometry.disparity(kWall_m) + 4.0);
  EXPECT_FALSE(view.mayHide());
}

TEST(HiddenThings, AHoleAmidNothingThatIsMatchedMayHideOne) {
  View view(kMiddle, pixels(0.14, 4.0));
  view.disparity.matched_px.setTo(kNothing);
  EXPECT_TRUE(view.mayHide());
}

TEST(HiddenThings, HolesOutsideOfTheFarPartsViewAreNotLookedAt) {
  const int beside_px = pixels(0.6, 3.4) + pixels(0.14, 4.0);
  EXPECT_FALSE(View(kMiddle + cv::Point(beside_px, 0), pixels(0.14, 4.0)).mayHide());
  EXPECT_TRUE(View(kMiddle + cv::Point(pixels(0.55, 3.4), 0), pixels(0.14, 4.0)).mayHide());
}

TEST(HiddenThings, WithoutAPairOrABoxInViewThereIsNone) {
  EXPECT_FALSE(mayHideThing(corridor(), DepthImages(), Disparity(), kGeometry));
  Box behind = corridor();
  behind.T_M_F.translation().z() = -9.0;
  EXPECT_FALSE(View(kMiddle, pixels(0.14, 4.0)).mayHide(behind));
}

}  // namespace
}  // namespace flight_corridor
