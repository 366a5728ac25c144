#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "sim/render.hpp"
#include "sim/rig.hpp"
#include "sim/scenes.hpp"

namespace flight_corridor::sim {
namespace {

constexpr double kSinglePrecision = 1e-4;  // relative; float's 6e-8 through a dozen operations, ill-conditioned aslant

Rig smallRig() {
  Rig rig = defaultRig();
  scaleImages(rig, 0.25);
  return rig;
}

/// Left camera with C = W.
Camera cameraAtOrigin(const Rig& rig) {
  Camera camera = leftCamera(rig, Eigen::Isometry3d::Identity());
  camera.T_W_C.setIdentity();
  return camera;
}

/// Largest of |distance(p_C)| over the points of a depth image.
template <typename Distance>
double largestOverPoints(const cv::Mat& depth_m, const StereoGeometry& geometry, const Distance& distance) {
  double largest_m = 0.0;
  for (int v = 0; v < depth_m.rows; ++v) {
    for (int u = 0; u < depth_m.cols; ++u) {
      const float z_m = depth_m.at<float>(v, u);
      if (!std::isnan(z_m)) largest_m = std::max(largest_m, std::abs(distance(geometry.point(u, v, z_m))));
    }
  }
  return largest_m;
}

int countSurface(const cv::Mat& depth_m) { return cv::countNonZero(depth_m == depth_m); }

TEST(Render, PointsOfTheDepthImageLieOnTheSphere) {
  const Rig rig = smallRig();
  const Eigen::Vector3d centre(0.4, -0.2, 5.0);
  const cv::Mat depth_m = render({makeSphere(centre, 1.0, {})}, cameraAtOrigin(rig)).depth_m;
  const double off_m = largestOverPoints(depth_m, StereoGeometry(rig.calibration),
                                         [&](const Eigen::Vector3d& p_C) { return (p_C - centre).norm() - 1.0; });
  EXPECT_LT(off_m, kSinglePrecision * 5.0);
  // Its disc: pi * (f r / Z)^2 = 962 px, a little more for perspective.
  EXPECT_NEAR(countSurface(depth_m), 1000, 60);
}

TEST(Render, PointsOfTheDepthImageLieOnATiltedCylinder) {
  const Rig rig = smallRig();
  const Eigen::Vector3d from(-2, 1, 4), to(2, -1, 6);
  const Eigen::ParametrizedLine<double, 3> axis(from, (to - from).normalized());
  const cv::Mat depth_m = render({makeCylinder(from, to, 0.3, {})}, cameraAtOrigin(rig)).depth_m;
  const double off_m = largestOverPoints(depth_m, StereoGeometry(rig.calibration), [&](const Eigen::Vector3d& p_C) {
    const bool on_cap = std::abs((p_C - from).dot(axis.direction())) < 1e-3;
    return on_cap ? 0.0 : axis.distance(p_C) - 0.3;
  });
  EXPECT_LT(off_m, kSinglePrecision * 6.0);
  EXPECT_GT(countSurface(depth_m), 500);
}

TEST(Render, PointsOfTheDepthImageLieOnATurnedBox) {
  const Rig rig = smallRig();
  Primitive box = makeBox({0.3, 0.1, 4.0}, {1.0, 2.0, 0.5}, {});
  box.T_W_O.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 1, 0).normalized()));
  const cv::Mat depth_m = render({box}, cameraAtOrigin(rig)).depth_m;
  const double off_m = largestOverPoints(depth_m, StereoGeometry(rig.calibration), [&](const Eigen::Vector3d& p_C) {
    const Eigen::Vector3d p_O = box.T_W_O.inverse() * p_C;
    return (p_O.cwiseAbs() - box.half_m).maxCoeff();  // 0 on the surface
  });
  EXPECT_LT(off_m, kSinglePrecision * 4.0);
  EXPECT_GT(countSurface(depth_m), 500);
}

TEST(Render, CullingLosesNothingThatARayThroughTheWholeWorldMeets) {
  const Scene forest = makeScene("forest", 5);
  const Rig rig = smallRig();
  const Camera camera =
      leftCamera(rig, forest.flight.T_W_B(3.0) * Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 1, 1).normalized()));
  const cv::Mat depth_m = render(forest.world, camera).depth_m;
  for (int v = 0; v < depth_m.rows; ++v) {
    for (int u = 0; u < depth_m.cols; ++u) {
      const Eigen::Vector3d direction_C((u - camera.cx_px) / camera.fx_px, (v - camera.cy_px) / camera.fy_px, 1.0);
      double nearest_m = kInfinity;
      for (const Primitive& primitive : forest.world) {
        const Eigen::Isometry3d T_O_C = primitive.T_W_O.inverse() * camera.T_W_C;
        const auto hit =
            intersect(primitive, T_O_C.translation().cast<float>(), (T_O_C.linear() * direction_C).cast<float>());
        if (hit) nearest_m = std::min<double>(nearest_m, hit->t);
      }
      const float rendered_m = depth_m.at<float>(v, u);
      if (nearest_m == kInfinity) {
        EXPECT_TRUE(std::isnan(rendered_m)) << u << ", " << v;
      } else {
        EXPECT_NEAR(rendered_m, nearest_m, 1e-3 * nearest_m) << u << ", " << v;
      }
    }
  }
}

TEST(Render, SkyHasNoDepthAndIsBright) {
  const Rendering sky = render({}, cameraAtOrigin(smallRig()));
  EXPECT_EQ(countSurface(sky.depth_m), 0);
  EXPECT_EQ(cv::countNonZero(sky.radiance == 1.0f), static_cast<int>(sky.radiance.total()));
}

TEST(Render, LeavesOutWhatTheCameraDoesNotSee) {
  Material glass;
  glass.camera_sees = false;
  const Rendering seen = render({makeSphere({0, 0, 3}, 1.0, glass)}, cameraAtOrigin(smallRig()));
  EXPECT_EQ(countSurface(seen.depth_m), 0);
}

TEST(Render, AMirrorShowsWhatStandsBehindTheCameraTwiceAsFarAsItself) {
  Material black, polished;
  black.grey = polished.grey = 0.0f;
  polished.mirror = 1.0f;
  const Camera camera = cameraAtOrigin(smallRig());
  const Primitive mirror = makeBox({0, 0, 4.05}, {40, 40, 0.1}, polished);
  const Rendering reflected = render({mirror, makeSphere({0.7, 0.3, -2.0}, 0.8, black)}, camera);
  const Rendering image = render({makeSphere({0.7, 0.3, 2.0 * 4.0 + 2.0}, 0.8, black)}, camera);
  EXPECT_GT(countSurface(image.depth_m), 100);
  // Of an outline pixel's eight rays rounding may let one pass.
  EXPECT_LE(cv::norm(reflected.radiance, image.radiance, cv::NORM_INF), 1.01 / 8.0);
  EXPECT_NEAR(reflected.depth_m.at<float>(60, 80), 4.0f, 1e-3f);
}

TEST(Render, AHalfMirrorShowsHalfOfItsOwnSurface) {
  Material half;
  half.grey = 0.2f;
  half.contrast = 0.0f;
  const Camera camera = cameraAtOrigin(smallRig());
  const auto middle = [&](float mirror) {
    half.mirror = mirror;
    return render({makeBox({0, 0, 4.05}, {40, 40, 0.1}, half)}, camera).radiance.at<float>(60, 80);
  };
  EXPECT_NEAR(middle(0.5f), (middle(0.0f) + 1.0f) / 2.0f, 1e-6f);  // the sky's 1
}

TEST(Render, AThinPoleKeepsItsWidthWhereverItStandsBetweenPixels) {
  Material black;
  black.grey = 0.0f;
  black.contrast = 0.0f;
  const Rig rig = smallRig();
  const double width_px = 1.3;
  const double width_m = width_px * 4.0 / rig.calibration.fx_px;
  for (double shift_px = 0.0; shift_px < 1.0; shift_px += 0.07) {
    const double x_m = shift_px * 4.0 / rig.calibration.fx_px;
    const cv::Mat row =
        1.0 - render({makeBox({x_m, 0, 4.0005}, {width_m, 2, 0.001}, black)}, cameraAtOrigin(rig)).radiance.row(60);
    // Each edge is placed to one of eight columns.
    EXPECT_NEAR(cv::sum(row)[0], width_px, 2.0 / 8.0) << shift_px;
  }
}

TEST(Render, HazeHidesWhatIsFarAndNotWhatIsNear) {
  Material black;
  black.grey = 0.0f;
  Light light;
  light.haze_m = 20.0;
  const auto radianceAt = [&](double distance_m) {
    const Primitive wall = makeBox({0, 0, distance_m + 0.05}, {400, 400, 0.1}, black);
    return render({wall}, cameraAtOrigin(smallRig()), light).radiance.at<float>(60, 80);
  };
  const float near = radianceAt(0.2), middle = radianceAt(20.0), far = radianceAt(200.0);
  EXPECT_LT(near, 0.01f);
  EXPECT_NEAR(middle, 0.632f * far, 1e-3f);
}

TEST(Render, OnlyTheShadeIsDarkerForShadows) {
  const Primitive ground = makeBox({0, 0, -0.5}, {40, 40, 1}, {}), ball = makeSphere({6, 0, 2.0}, 1.0, {});
  Light light;
  light.to_sun_W = Eigen::Vector3d::UnitZ();
  Rig rig = smallRig();
  Camera camera = leftCamera(rig, Eigen::Isometry3d(Eigen::Translation3d(0, 0, 1.5)));
  const cv::Mat plain = render({ground, ball}, camera, light).radiance;
  light.shadows =
      std::make_shared<const Shadows>(std::vector<Primitive>{ground, ball}, light.to_sun_W,
                                      Eigen::AlignedBox3d(Eigen::Vector3d(0, -5, 0), Eigen::Vector3d(12, 5, 4)));
  const cv::Mat shaded = render({ground, ball}, camera, light).radiance;
  const cv::Mat darker = shaded < 0.999f * plain;
  EXPECT_EQ(cv::countNonZero(shaded > plain), 0);
  // 1.5 m above the ground, 6 m before the camera: 21.9 rows below its axis; 4 m away the sun shines.
  EXPECT_GT(darker.at<std::uint8_t>(60 + 22, 79), 0);
  EXPECT_EQ(darker.at<std::uint8_t>(60 + 33, 79), 0);
}

}  // namespace
}  // namespace flight_corridor::sim
