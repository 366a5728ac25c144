#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/texture.hpp"

namespace flight_corridor::sim {
namespace {

struct Moments {
  double mean, std;
};

/// Over a square metre and more of a plane.
Moments momentsOf(const Material& material, float footprint_m) {
  double sum = 0.0, squares = 0.0;
  constexpr int kEdge = 200;
  for (int i = 0; i < kEdge * kEdge; ++i) {
    const Eigen::Vector3f p_O(0.037f * static_cast<float>(i % kEdge), 0.041f * static_cast<float>(i / kEdge), 0.15f);
    const double value = reflectance(material, p_O, footprint_m);
    sum += value;
    squares += value * value;
  }
  const double mean = sum / (kEdge * kEdge);
  return {mean, std::sqrt(std::max(squares / (kEdge * kEdge) - mean * mean, 0.0))};
}

TEST(Reflectance, IsEvenOnABlankSurface) {
  Material blank;
  blank.contrast = 0.0f;
  EXPECT_EQ(reflectance(blank, {0.1f, 0.2f, 0.3f}, 0.01f), blank.grey);
  EXPECT_EQ(reflectance(blank, {-7.1f, 0.2f, 9.3f}, 0.01f), blank.grey);
}

TEST(Reflectance, HasTheMaterialsMeanAndEnoughContrastToMatch) {
  const Material material;
  const Moments moments = momentsOf(material, 0.01f);
  // About 8 m by 8 m of cells of 0.64 m: 150 coarse values, each octave's std 0.3 * 0.35: mean to 0.01.
  EXPECT_NEAR(moments.mean / material.grey, 1.0, 0.04);
  EXPECT_GT(moments.std / material.grey, 0.10);
}

TEST(Reflectance, FadesWithTheFootprintToTheMean) {
  const Material material;
  double std = momentsOf(material, 0.005f).std;
  for (const float footprint_m : {0.02f, 0.05f, 0.1f, 0.2f}) {
    const double coarser_std = momentsOf(material, footprint_m).std;
    EXPECT_LT(coarser_std, std) << footprint_m;
    std = coarser_std;
  }
  EXPECT_NEAR(momentsOf(material, 0.4f).std, 0.0, 1e-6);  // 0.64 m is below two footprints
}

TEST(Reflectance, IsContinuous) {
  const Material material;
  for (int i = 0; i < 5000; ++i) {
    const float x_m = -2.0f + 0.001f * static_cast<float>(i);
    const float change =
        reflectance(material, {x_m + 1e-4f, 0.3f, 0.2f}, 0.01f) - reflectance(material, {x_m, 0.3f, 0.2f}, 0.01f);
    // Steepest octave: 0.02 m, from -1 to 1 with slope 1.5: 150 per metre, two finer octaves half faded, coarser ones
    // half each.
    EXPECT_LT(std::abs(change), 1e-4f * 450.0f * material.contrast * material.grey) << x_m;
  }
}

TEST(Reflectance, DiffersBySeed) {
  Material one, other;
  other.seed = 1;
  EXPECT_NE(reflectance(one, {0.1f, 0.2f, 0.3f}, 0.01f), reflectance(other, {0.1f, 0.2f, 0.3f}, 0.01f));
}

TEST(Reflectance, ACheckerRepeatsAfterItsPeriodAndTurnsOverAfterHalf) {
  Material checker;
  checker.contrast = 0.0f;
  checker.checker_period_m = 0.4f;
  const auto at = [&](float x_m) { return reflectance(checker, {x_m, 0.0f, 0.0f}, 0.01f); };
  EXPECT_NEAR(at(0.0f), 1.5f * checker.grey, 1e-5f);
  EXPECT_NEAR(at(0.2f), 0.5f * checker.grey, 1e-5f);
  EXPECT_NEAR(at(0.1f), checker.grey, 1e-5f);  // on the edge
  for (float x_m = -1.0f; x_m < 1.0f; x_m += 0.03f) EXPECT_NEAR(at(x_m), at(x_m + 0.4f), 1e-3f) << x_m;
}

}  // namespace
}  // namespace flight_corridor::sim
