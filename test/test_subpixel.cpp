#include <gtest/gtest.h>

#include <cmath>

#include "flight_corridor/stereo/subpixel.hpp"
#include "support/matcher_cases.hpp"

namespace flight_corridor {
namespace {

using namespace matcher_cases;

constexpr WindowMoments kBare{};

TEST(SubpixelOffset, IsTheParabolasWhereTheWindowIsBare) {
  EXPECT_EQ(subpixelOffset(20, 10, 20, kBare), 0);
  EXPECT_EQ(subpixelOffset(10, 10, 20, kBare), -kSubpixels / 2);
  EXPECT_EQ(subpixelOffset(20, 10, 10, kBare), kSubpixels / 2);
  EXPECT_EQ(subpixelOffset(10, 10, 10, kBare), 0);  // flat: anywhere
}

TEST(SubpixelOffset, ChangesSidesWithItsInputs) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const int least = static_cast<int>(random() % 50), below = least + static_cast<int>(random() % 60);
    const int above = least + static_cast<int>(random() % 60);
    WindowMoments window, mirrored;
    window.gg = mirrored.gg = static_cast<std::int32_t>(random() % 200000);
    window.ge = static_cast<std::int32_t>(random() % 50000) - 25000;
    mirrored.ge = -window.ge;
    const int offset = subpixelOffset(below, least, above, window);
    EXPECT_NEAR(subpixelOffset(above, least, below, mirrored), -offset, 1) << i;  // halves are rounded upwards
    EXPECT_LE(std::abs(offset), kSubpixels) << i;
  }
}

/// Right image: waves; left image: the same moved by a disparity.
struct Waves {
  static constexpr int kWidth_px = 200, kHeight_px = 3;

  explicit Waves(double disparity_px) : left(kWidth_px * kHeight_px), right(left) {
    for (int v = 0; v < kHeight_px; ++v) {
      for (int u = 0; u < kWidth_px; ++u) {
        left[v * kWidth_px + u] = grey(u - disparity_px, v);
        right[v * kWidth_px + u] = static_cast<std::uint8_t>(grey(u, v) + 20);  // exposed otherwise
      }
    }
  }

  static std::uint8_t grey(double u, int v) {
    return static_cast<std::uint8_t>(std::lround(100 + 40 * std::sin(u * 0.5 + v) + 30 * std::sin(u * 0.23 - 2 * v)));
  }

  static GreyImage view(const std::vector<std::uint8_t>& pixels) {
    return {pixels.data(), kWidth_px, kHeight_px, kWidth_px};
  }

  std::vector<std::uint8_t> left, right;
};

TEST(SubpixelFit, HalvesTheErrorOfAParabolaThatIsDrawnToWholePixels) {
  constexpr int kDisparity_px = 20, kStored = kDisparityStep;
  AlignedBytes sums(Waves::kWidth_px * kStored);
  std::fill_n(sums.data(), Waves::kWidth_px * kStored, std::uint8_t{90});
  for (int u = 0; u < Waves::kWidth_px; ++u) sums.data()[u * kStored + kDisparity_px] = 10;  // symmetric: whole
  const std::vector<std::uint8_t> winner(Waves::kWidth_px, kDisparity_px);
  std::vector<std::uint8_t> flags(Waves::kWidth_px, kConsistent);
  std::fill_n(flags.begin(), kDisparity_px, std::uint8_t{0});  // not on the right image
  std::vector<std::int16_t> fixed(Waves::kWidth_px);
  for (const double error_px : {-0.4, -0.2, 0.0, 0.3}) {
    const Waves waves(kDisparity_px + error_px);
    SubpixelFit(Waves::kWidth_px, 0, 64)
        .fit(Waves::view(waves.left), Waves::view(waves.right), 1, sums.data(), winner.data(), flags.data(),
             fixed.data());
    for (int u = 30; u + 10 < Waves::kWidth_px; ++u) {
      const double found_px = fixed[u] / double{kSubpixels} - kDisparity_px;
      EXPECT_NEAR(found_px, error_px / 2, 0.06) << u;  // rounding of grey values over a gradient of some 15: 0.03
    }
  }
}

TEST(SubpixelPlane, AveragesOneSurfaceOnly) {
  constexpr int kWidth_px = 45, kHeight_px = 9;
  SubpixelPlane plane(kWidth_px, kHeight_px);
  std::vector<std::int16_t> fixed;
  std::mt19937 random(2);
  for (int v = 0; v < kHeight_px; ++v) {
    for (int u = 0; u < kWidth_px; ++u) {
      const int surface_px = u < 20 ? 30 : 40;
      const bool none = random() % 5 == 0;
      plane.row(v)[u] = static_cast<std::int16_t>(
          none ? kNoSubpixel : surface_px * kSubpixels + static_cast<int>(random() % kSubpixels) - kSubpixels / 2);
      fixed.push_back(plane.row(v)[u]);
    }
  }
  std::vector<float> best(kWidth_px);
  for (int v = 0; v < kHeight_px; ++v) {
    plane.average(v, best.data());
    for (int u = 0; u < kWidth_px; ++u) {
      const float slow = oracle::averageAt(fixed, kWidth_px, kHeight_px, u, v);
      EXPECT_TRUE(best[u] == slow || (std::isnan(best[u]) && std::isnan(slow))) << u << " " << v;
      const float surface_px = u < 20 ? 30.0f : 40.0f;
      EXPECT_FALSE(std::abs(best[u] - surface_px) > 0.5f) << u << " " << v;  // NaN is none
    }
  }
}

}  // namespace
}  // namespace flight_corridor
