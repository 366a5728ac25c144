#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "sim/projector.hpp"
#include "sim/render.hpp"
#include "sim/simulation.hpp"

namespace flight_corridor::sim {
namespace {

constexpr float kSharp = 1e-4f;
constexpr float kTileAcross = 2.0f * 0.93f / 5.0f;

TEST(DotProjector, ThrowsAboutFiveThousandDots) {
  int dots = 0;
  constexpr float kStep = 0.0005f;
  const auto at = [&](float across, float down) { return dotPattern(across, down, kSharp, 1); };
  for (float down = -0.55f; down < 0.55f; down += kStep) {
    for (float across = -0.94f; across < 0.94f; across += kStep) {
      const float middle = at(across, down);
      if (middle < 0.9f) continue;
      dots += middle > at(across - kStep, down) && middle >= at(across + kStep, down) &&
              middle > at(across, down - kStep) && middle >= at(across, down + kStep);
    }
  }
  EXPECT_NEAR(dots, 5000, 500);
}

TEST(DotProjector, RepeatsItsLayoutSideBySideAndLeavesTheRestDark) {
  double difference = 0.0, within = 0.0;
  for (float across = -0.9f; across < 0.5f; across += 0.003f) {
    const float light = dotPattern(across, 0.1f, kSharp, 1);
    difference += std::abs(light - dotPattern(across + kTileAcross, 0.1f, kSharp, 1));
    within += std::abs(light - dotPattern(across + 0.5f * kTileAcross, 0.1f, kSharp, 1));
  }
  EXPECT_LT(difference, 0.01 * within);
  EXPECT_EQ(dotPattern(0.95f, 0.0f, kSharp, 1), 0.0f);
  EXPECT_EQ(dotPattern(0.0f, 0.6f, kSharp, 1), 0.0f);
}

TEST(DotProjector, LightFallsWithTheSquareOfDistanceAndTheCosineOfIncidence) {
  const ProjectedDots dots{{Eigen::Isometry3d::Identity(), 2.0, 1}, Eigen::Isometry3d::Identity()};
  const Eigen::Vector3f ahead(0.2f, 0.1f, 1.0f), towards = -ahead.normalized();
  const Eigen::Vector3f aslant =
      (Eigen::AngleAxisf(static_cast<float>(M_PI / 3.0), ahead.unitOrthogonal()) * towards).normalized();
  constexpr float kBlurred = 0.05f;  // all over the view there is light
  const float near = dots.light(ahead, towards, kBlurred);
  ASSERT_GT(near, 0.0f);
  EXPECT_NEAR(dots.light(3.0f * ahead, towards, kBlurred), near / 9.0f, 1e-4f * near);
  EXPECT_NEAR(dots.light(ahead, aslant, kBlurred), near / 2.0f, 1e-4f * near);
  EXPECT_EQ(dots.light(ahead, -towards, kBlurred), 0.0f);
  EXPECT_EQ(dots.light(-ahead, towards, kBlurred), 0.0f);
}

/// The left camera sees the dots nearly where they were, however far the wall: they move with the camera.
TEST(DotProjector, DotsStandStillInTheLeftImageWhileTheWallComesNearer) {
  Scene scene;
  for (std::uint64_t seed = 0; !(scene.projector && scene.projector->strength > 5.0); ++seed) {
    scene = makeScene("projector", seed);
  }
  const double strength = scene.projector->strength;
  const auto dotsAt = [&](double wall_m) {
    Light light;
    light.dots = ProjectedDots{*scene.projector, scene.projector->T_C_P.inverse()};
    Material wall;
    wall.contrast = 0.0f;
    const Primitive primitive = makeBox({0.0, 0.0, wall_m + 0.5}, {60.0, 60.0, 1.0}, wall);
    const Camera camera{{320, 240}, 350.0, 350.0, 160.0, 120.0, Eigen::Isometry3d::Identity()};
    cv::Mat radiance = render({primitive}, camera, light).radiance, spread;
    cv::Scalar mean, std;
    cv::meanStdDev(radiance, mean, std);
    cv::Mat((radiance - mean[0]) / std[0]).copyTo(spread);
    return std::make_pair(spread, std[0]);
  };
  const auto [far, far_std] = dotsAt(8.0);
  const auto [near, near_std] = dotsAt(4.0);
  EXPECT_GT(far_std, 0.0005 * strength);
  EXPECT_NEAR(near_std / far_std, 4.0, 0.3);
  const cv::Mat shifted = near(cv::Rect(1, 0, 300, 240));  // 0.03 m beside the lens: 350 * 0.03 (1/4 - 1/8) = 1.3 px
  EXPECT_GT(shifted.dot(far(cv::Rect(0, 0, 300, 240))) / static_cast<double>(shifted.total()), 0.8);
}

TEST(DotProjector, NothingIsLitBehindWhatItsLightMeets) {
  Light light;
  light.dots = ProjectedDots{{Eigen::Isometry3d::Identity(), 20.0, 1}, Eigen::Isometry3d::Identity()};
  Material wall;
  wall.contrast = 0.0f;
  const std::vector<Primitive> walls = {makeBox({0.0, 0.0, 4.5}, {60.0, 60.0, 1.0}, wall),
                                        makeBox({-0.5, 0.0, 2.0}, {0.5, 0.5, 0.1}, wall)};
  const Camera beside{{320, 240}, 350.0, 350.0, 160.0, 120.0, Eigen::Isometry3d(Eigen::Translation3d(-1.0, 0.0, 0.0))};
  const cv::Mat radiance = render(walls, beside, light).radiance;
  // The shadow on the wall is about (-1.0, 0.0, 4.0): straight ahead of the camera.
  double least = 0.0, most = 0.0;
  cv::minMaxLoc(radiance(cv::Rect(150, 110, 20, 20)), &least, &most);
  EXPECT_FLOAT_EQ(static_cast<float>(least), static_cast<float>(most));
  cv::minMaxLoc(radiance(cv::Rect(20, 20, 40, 40)), &least, &most);
  EXPECT_GT(most, 1.2 * least);
}

}  // namespace
}  // namespace flight_corridor::sim
