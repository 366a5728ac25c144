#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "sim/glare.hpp"

namespace flight_corridor::sim {
namespace {

/// C = W, one milliradian per pixel in the middle.
Camera camera() { return {{401, 301}, 1000.0, 1000.0, 200.0, 150.0, Eigen::Isometry3d::Identity()}; }

Sun sunAhead() { return {Eigen::Vector3d::UnitZ(), 0.05}; }

/// Radiance that the sun ahead adds to a black image.
cv::Mat glareBehind(const std::vector<Primitive>& primitives, const Sun& sun = sunAhead()) {
  cv::Mat radiance(301, 401, CV_32FC1, cv::Scalar(0.0));
  addGlare(sun, primitives, camera(), radiance);
  return radiance;
}

TEST(Glare, IsWhiteUpToItsSaturatedAngleAndFallsWithTheSquareOfTheAngle) {
  const cv::Mat glare = glareBehind({});
  const auto atAngle = [&](double angle_rad) {
    return glare.at<float>(150, 200 + static_cast<int>(std::lround(1000.0 * std::tan(angle_rad))));
  };
  // Half a pixel of 1 mrad at 50 mrad is 1 %, of the square 2 %.
  EXPECT_NEAR(atAngle(0.05), 1.0, 0.02);
  EXPECT_NEAR(atAngle(0.10), 0.25, 0.25 * 0.01);
  EXPECT_NEAR(atAngle(0.15), 1.0 / 9.0, 1.0 / 9.0 * 0.01);
  EXPECT_GT(atAngle(0.01), 20.0);
}

TEST(Glare, IsGoneWhereSomethingThatTheCameraSeesStandsBeforeTheSun) {
  Material glass;
  glass.camera_sees = false;
  EXPECT_EQ(cv::norm(glareBehind({makeSphere({0, 0, 3}, 0.5, {})}), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(glareBehind({makeSphere({1, 0, 3}, 0.5, {})}), cv::NORM_INF), 1.0);
  EXPECT_GT(cv::norm(glareBehind({makeSphere({0, 0, 3}, 0.5, glass)}), cv::NORM_INF), 1.0);
}

TEST(Glare, HardlyComesFromASunBehindTheCamera) {
  Sun behind = sunAhead();
  behind.to_sun_W = -Eigen::Vector3d::UnitZ();
  EXPECT_LT(cv::norm(glareBehind({}, behind), cv::NORM_INF), 0.001);
}

}  // namespace
}  // namespace flight_corridor::sim
