#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "flight_corridor/stereo/rectification_watch.hpp"
#include "sim/rig.hpp"
#include "sim/simulation.hpp"
#include "sim/still.hpp"
#include "support/wrong_lens.hpp"

namespace flight_corridor {
namespace {

using namespace test_support;

const StereoGeometry kGeometry(sim::defaultRig().calibration);

/// Walls of a room and a floor.
std::vector<sim::Primitive> room() {
  sim::Random random(1, sim::Stream::Scene);
  return {sim::backdrop(5.0, sim::masonry(random)),
          sim::makeBox({3.0, 0.0, -0.1}, {12.0, 8.0, 0.2}, sim::textured(random, 0.4, 0.3, 0.3)),
          sim::makeBox({3.0, 2.2, 1.5}, {12.0, 0.2, 4.0}, sim::masonry(random)),
          sim::makeBox({3.0, -2.2, 1.5}, {12.0, 0.2, 4.0}, sim::masonry(random))};
}

std::vector<StereoFrame> stills(int count) {
  static const std::vector<sim::Primitive> world = room();
  std::vector<StereoFrame> pairs;
  for (int i = 0; i < count; ++i) {
    pairs.push_back(sim::stillPair(world, 1 + static_cast<std::uint64_t>(i)));
    pairs.back().stamp_s = 1.0 + 0.1 * i;
  }
  return pairs;
}

cv::Mat warped(const cv::Mat& image, const cv::Matx33d& homography) {
  cv::Mat result;
  cv::warpPerspective(image, result, homography, image.size(), cv::INTER_LINEAR);
  return result;
}

cv::Mat lowered(const cv::Mat& image, double down_px) { return warped(image, {1, 0, 0, 0, 1, down_px, 0, 0, 1}); }

/// As a camera shows it that is turned about its x (pitch), y (yaw) and z (roll).
cv::Mat turned(const cv::Mat& image, const cv::Vec3d& angles_deg) {
  const StereoCalibration c = sim::defaultRig().calibration;
  const cv::Matx33d K(c.fx_px, 0, c.cx_px, 0, c.fy_px, c.cy_px, 0, 0, 1);
  cv::Matx33d R;
  cv::Rodrigues(CV_PI / 180.0 * angles_deg, R);
  return warped(image, K * R * K.inv());
}

/// After so many pairs, of which the right images were changed.
template <class Change>
RowAgreement after(std::vector<StereoFrame> pairs, Change change) {
  RectificationWatch watch{kGeometry};
  StereoFrame before;
  for (StereoFrame& pair : pairs) {
    pair.right = change(pair.right);
    watch.look(pair, before);
    before = pair;
  }
  return watch.agreement();
}

TEST(RectificationWatch, NeverAccusesAGoodRig) {
  for (const std::string scene : {"wall", "fence", "net", "rain", "turning", "banking", "oncoming", "checker_wall",
                                  "low_light", "exposure_difference", "foliage", "motion_blur", "mirror"}) {
    sim::SimulationOptions options;
    options.scene = scene;
    options.seed = 5;
    options.rate_hz = 1.5;
    const sim::Simulation simulation(options);
    RectificationWatch watch{kGeometry};
    StereoFrame before;
    for (std::size_t i = 0; i < 5; ++i) {
      const StereoFrame pair = simulation.frame(i);
      const RowAgreement& rows = watch.look(pair, before);
      EXPECT_EQ(rows.fault, RowFault::None) << scene << " " << rows.offset_px;
      EXPECT_FALSE(std::abs(rows.offset_px) > 0.5) << scene << " " << rows.offset_px;
      before = pair;
    }
  }
}

TEST(RectificationWatch, ToleratesARowThatMatchingTolerates) {
  for (const double down_px : {-1.0, -0.5, 0.7, 1.0}) {
    const RowAgreement rows = after(stills(3), [&](const cv::Mat& image) { return lowered(image, down_px); });
    EXPECT_EQ(rows.fault, RowFault::None) << down_px;
    EXPECT_NEAR(rows.centre_px, down_px, 0.1);  // of the match
  }
}

TEST(RectificationWatch, NamesAnImageThatIsTooLowOrTooHighInTheFirstPair) {
  for (const double down_px : {-5.0, -3.0, -2.0, 2.0, 4.0, 9.0}) {
    const RowAgreement rows = after(stills(1), [&](const cv::Mat& image) { return lowered(image, down_px); });
    EXPECT_EQ(rows.fault, RowFault::Offset) << down_px;
    EXPECT_NEAR(rows.offset_px, down_px, 0.5) << "largest part";
  }
}

TEST(RectificationWatch, NamesACameraThatIsPitchedOrRolled) {
  for (const double angle_deg : {-2.0, -1.0, -0.4, 0.4, 1.0, 2.0}) {  // 0.4 deg of pitch are 2.4 px
    const RowAgreement pitched = after(stills(2), [&](const cv::Mat& image) {
      return turned(image, {angle_deg, 0, 0});
    });
    EXPECT_EQ(pitched.fault, RowFault::Offset) << angle_deg;
    if (std::abs(angle_deg) < 1.0) continue;  // at the middle of an outer part 0.4 deg of roll are 1.5 px
    const RowAgreement rolled = after(stills(2), [&](const cv::Mat& image) {
      return turned(image, {0, 0, angle_deg});
    });
    EXPECT_EQ(rolled.fault, RowFault::Warp) << angle_deg;
  }
}

TEST(RectificationWatch, NamesAFisheyeThatIsTakenForPlumbBob) {
  for (const bool is_right : {false, true}) {
    RectificationWatch watch{kGeometry};
    for (std::uint64_t seed = 1; seed <= 2; ++seed) watch.look(throughFisheyes(room(), seed, is_right), {});
    EXPECT_EQ(watch.agreement().fault, is_right ? RowFault::None : RowFault::Lens) << watch.agreement().lens_error;
  }
}

TEST(RectificationWatch, WithoutEvidenceItSaysNothingNew) {
  const StereoFrame blank{1.0, cv::Mat(480, 640, CV_8UC1, 100), cv::Mat(480, 640, CV_8UC1, 100)};
  RectificationWatch watch{kGeometry};
  EXPECT_EQ(watch.look(blank, {}).fault, RowFault::None);
  for (StereoFrame pair : stills(3)) {
    pair.right = lowered(pair.right, 4.0);
    watch.look(pair, {});
  }
  for (int i = 0; i < 20; ++i) EXPECT_EQ(watch.look(blank, blank).fault, RowFault::Offset);
}

TEST(RectificationWatch, FindsAKnockInFlightAndItsEnd) {
  RectificationWatch watch{kGeometry};
  int pairs = 0;
  const auto until = [&](RowFault fault, double down_px) {
    for (StereoFrame pair : stills(15)) {
      ++pairs;
      pair.right = lowered(pair.right, down_px);
      if (watch.look(pair, {}).fault == fault) return true;
    }
    return false;
  };
  until(RowFault::Warp, 0.0);
  EXPECT_EQ(watch.agreement().fault, RowFault::None);
  pairs = 0;
  EXPECT_TRUE(until(RowFault::Offset, 4.0));
  EXPECT_LE(pairs, 12) << "a tenth is looked at, and if it is suspect, the next one";
  pairs = 0;
  EXPECT_TRUE(until(RowFault::None, 0.0));
  EXPECT_LE(pairs, 3) << "while something is wrong, each";
}

/// A flight at 15 Hz of which one camera's images come one pair late.
class LateImage : public testing::TestWithParam<const char*> {
 protected:
  RowFault fly(bool is_right, std::size_t first, std::size_t end, bool is_late) {
    for (std::size_t i = first; i < end; ++i) {
      StereoFrame pair = simulation_.frame(i);
      if (is_late) (is_right ? pair.right : pair.left) = (is_right ? last_.right : last_.left);
      last_ = simulation_.frame(i);
      watch_.look(pair, before_);
      before_ = pair;
    }
    return watch_.agreement().fault;
  }

  static sim::SimulationOptions options() {
    sim::SimulationOptions options;
    options.scene = GetParam();
    options.seed = 4002;
    options.rate_hz = 15.0;
    return options;
  }

  const sim::Simulation simulation_{options()};
  RectificationWatch watch_{kGeometry};
  StereoFrame before_, last_ = simulation_.frame(9);
};

TEST_P(LateImage, IsNamedAndForgottenOnlyWhenItFitsAgain) {
  EXPECT_EQ(fly(true, 10, 16, true), RowFault::RightLate);
  EXPECT_EQ(fly(true, 16, 30, false), RowFault::None);
  EXPECT_EQ(fly(false, 30, 42, true), RowFault::LeftLate);
}

INSTANTIATE_TEST_SUITE_P(Scenes, LateImage, testing::Values("pole", "wall", "forest"));

TEST(RectificationWatch, AnImageThatWasLateIsNotForgivenForStandingStill) {
  RectificationWatch watch{kGeometry};
  sim::SimulationOptions options;
  options.scene = "pole";
  options.seed = 4002;
  options.rate_hz = 15.0;
  const sim::Simulation simulation(options);
  StereoFrame before, last = simulation.frame(9);
  for (std::size_t i = 10; i < 15; ++i) {
    StereoFrame pair = simulation.frame(i);
    std::swap(pair.right, last.right);
    watch.look(pair, before);
    before = pair;
  }
  ASSERT_EQ(watch.agreement().fault, RowFault::RightLate);
  for (const StereoFrame& pair : stills(8)) {
    watch.look(pair, before);
    before = pair;
  }
  EXPECT_EQ(watch.agreement().fault, RowFault::RightLate);
}

}  // namespace
}  // namespace flight_corridor
