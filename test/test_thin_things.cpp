#include <gtest/gtest.h>

#include "flight_corridor/corridor.hpp"
#include "flight_corridor/thin_things.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

const StereoGeometry kGeometry(test_support::smallCalibration());
constexpr double kBand_px = 0.12;
const Box kBox = Corridor(CorridorConfig()).box(opticalFromForward());

/// A thin level run of pixels ahead at one depth, all else far away and neither.
struct View {
  explicit View(double depth_m, int length_px = 40) {
    const cv::Rect run(kGeometry.size().width / 2, kGeometry.size().height / 2, length_px, 1);
    depth(run) = depth_m;
    disparity.level = cv::Mat::zeros(kGeometry.size(), CV_8U);
    disparity.level(run) = 255;
    disparity.thin = disparity.level.clone();
  }

  bool mayHold() const { return mayHoldThinThing(kBox, depth, disparity, kGeometry, kBand_px); }

  cv::Mat depth{kGeometry.size(), CV_32FC1, cv::Scalar(9.0)};
  Disparity disparity;
};

/// Depth at which the box's end is told to be by a match that is so much too far.
double endToldTooFar(double error_px) { return kGeometry.shiftedDepth(kBox.size_m.x(), -error_px); }

TEST(ThinThings, ALevelEdgeThatIsMatchedABitBehindTheBoxMayBeInIt) {
  EXPECT_TRUE(View(endToldTooFar(0.9)).mayHold());
  EXPECT_FALSE(View(endToldTooFar(1.1)).mayHold());
}

TEST(ThinThings, AFewPixelsAreChance) { EXPECT_FALSE(View(endToldTooFar(0.9), 11).mayHold()); }

TEST(ThinThings, AFewPixelsThatTheMapTakesToBeInTheBoxAreJudgedThere) {
  EXPECT_FALSE(View(endToldTooFar(0.9 * kBand_px), 20).mayHold());
  EXPECT_TRUE(View(endToldTooFar(1.1 * kBand_px), 20).mayHold());
}

TEST(ThinThings, ALeafsPixelsMayBeInTheBoxWithoutAHit) {
  EXPECT_TRUE(View(3.8, 32).mayHold());
  EXPECT_FALSE(View(3.8, 20).mayHold());
  View broad(3.8, 32);
  broad.disparity.thin.setTo(0);
  EXPECT_FALSE(broad.mayHold());
  View bent(3.8, 32);  // of its pixels but a few are matched with what is beside it
  bent.disparity.thin.colRange(kGeometry.size().width / 2 + 12, kGeometry.size().width).setTo(0);
  EXPECT_TRUE(bent.mayHold());
}

TEST(ThinThings, PixelsCountByWhatTheyShow) { EXPECT_FALSE(View(2.0, 60).mayHold()) << "as long as 15 at the end"; }

TEST(ThinThings, WhatIsNotLevelIsTakenToBeMatchedBetter) {
  for (const double error_px : {0.5, 0.7}) {
    View view(endToldTooFar(error_px));
    view.disparity.level.setTo(0);
    EXPECT_EQ(view.mayHold(), error_px == 0.5);
  }
}

TEST(ThinThings, WhatIsBroadIsWhereItIsMatched) {
  View view(endToldTooFar(0.5));
  view.disparity.thin.setTo(0);
  EXPECT_FALSE(view.mayHold());
}

TEST(ThinThings, WithoutAnImageThereAreNone) {
  EXPECT_FALSE(mayHoldThinThing(kBox, cv::Mat(), Disparity(), kGeometry, kBand_px));
}

TEST(ThinThings, NoDepthIsNowhere) {
  View view(endToldTooFar(0.9));
  view.depth.setTo(kNaN);
  EXPECT_FALSE(view.mayHold());
}

}  // namespace
}  // namespace flight_corridor
