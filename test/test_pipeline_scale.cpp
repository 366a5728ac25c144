#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "sim/render.hpp"
#include "sim/rig.hpp"
#include "sim/scene_parts.hpp"
#include "support/masonry.hpp"

// A world with its rig and corridor, and an image, have no size and no brightness of their own.

namespace flight_corridor {
namespace {

using World = std::vector<sim::Primitive>;

struct SizedPlace {
  std::string name;
  State state;
  World world;
};

/// Before a textured wall behind the corridor's end.
std::vector<SizedPlace> placesOfOneSize() {
  const sim::Material textured, bare = sim::plain(0.3);
  const double z_m = sim::kHeight_m;
  const auto before = [](const sim::Primitive& obstacle) { return World{test_support::masonryAt(6.0), obstacle}; };
  const auto post = [&](double radius_m, const sim::Material& material) {
    return before(sim::makeCylinder({2.5, 0.1, z_m - 2.0}, {2.5, 0.1, z_m + 2.0}, radius_m, material));
  };
  return {{"nothing", State::Free, {test_support::masonryAt(6.0)}},
          {"a box beside", State::Free, before(test_support::cubeAt({3.0, 0.95, z_m}, 0.4))},
          {"a wall", State::Blocked, {test_support::masonryAt(3.0)}},
          {"a ball of 6 cm", State::Blocked, before(sim::makeSphere({1.5, 0.1, z_m}, 0.03, textured))},
          {"a bare ball of 10 cm", State::Blocked, before(sim::makeSphere({2.5, 0.1, z_m}, 0.05, bare))},
          {"a post of 6 cm", State::Blocked, post(0.03, textured)},
          {"a bare post of 10 cm", State::Blocked, post(0.05, bare)},
          {"a bare wall", State::Unknown, {sim::backdrop(6.0, sim::plain(0.5))}}};
}

/// @param size of world, rig and corridor.  @param image of the images, 1 = 640x480.  @param gain, offset of their
/// grey.
Verdict judge(World world, double size, double image, double gain = 1.0, double offset = 0.0) {
  sim::Rig rig = sim::defaultRig();
  rig.calibration.baseline_m *= size;
  rig.T_B_C.translation() *= size;
  sim::scaleImages(rig, image);
  for (sim::Primitive& primitive : world) {
    primitive.T_W_O.translation() *= size;
    primitive.half_m *= size;
    for (float* length_m : {&primitive.material.coarsest_m, &primitive.material.finest_m}) {
      *length_m *= static_cast<float>(size);
    }
  }
  Config config;
  CorridorConfig& corridor = config.corridor;
  for (double* length_m : {&corridor.width_m, &corridor.height_m, &corridor.length_m, &corridor.blind_m,
                           &corridor.smallest_obstacle_m, &config.map.resolution_m, &config.map.max_range_m}) {
    *length_m *= size;
  }
  config.stereo.num_disparities_px = static_cast<int>(image * config.stereo.num_disparities_px);
  Eigen::Isometry3d T_W_B = Eigen::Isometry3d::Identity();
  T_W_B.translation() = Eigen::Vector3d(0.0, 0.0, size * sim::kHeight_m) - rig.T_B_C.translation();
  StereoFrame pair;
  pair.stamp_s = 1.0;
  pair.left = sim::expose(sim::render(world, sim::leftCamera(rig, T_W_B)).radiance, rig.left, 2);
  pair.right = sim::expose(sim::render(world, sim::rightCamera(rig, T_W_B)).radiance, rig.right, 3);
  for (cv::Mat* grey : {&pair.left, &pair.right}) grey->convertTo(*grey, CV_8U, gain, offset);
  return Pipeline(config, StereoGeometry(rig.calibration), Rig()).process(pair).verdict;
}

TEST(PipelineScale, AWorldAndItsRigOfAnotherSizeHaveTheSameVerdict) {
  for (const SizedPlace& place : placesOfOneSize()) {
    const Verdict usual = judge(place.world, 1.0, 1.0);
    EXPECT_EQ(usual.state, place.state) << place.name << ": " << describeReasons(usual.reasons);
    for (const double size : {0.5, 2.0}) {
      const Verdict verdict = judge(place.world, size, 1.0);
      EXPECT_EQ(verdict.state, place.state) << place.name << ", " << size << ": " << describeReasons(verdict.reasons);
      if (place.state != State::Blocked) continue;
      EXPECT_NEAR(verdict.clear_distance_m / size, usual.clear_distance_m, 0.04 * usual.clear_distance_m)
          << place.name << ", " << size;
    }
  }
}

TEST(PipelineScale, ImagesTwiceAsLargeHaveTheSameVerdict) {
  for (const SizedPlace& place : placesOfOneSize()) {
    const Verdict verdict = judge(place.world, 1.0, 2.0);
    EXPECT_EQ(verdict.state, place.state) << place.name << ": " << describeReasons(verdict.reasons);
  }
}

TEST(PipelineScale, DarkerAndBrighterImagesHaveTheSameVerdict) {
  for (const SizedPlace& place : placesOfOneSize()) {
    for (const auto& [gain, offset] : {std::pair{0.6, 0.0}, std::pair{0.7, 70.0}}) {
      const Verdict verdict = judge(place.world, 1.0, 1.0, gain, offset);
      EXPECT_EQ(verdict.state, place.state) << place.name << ", " << gain << ": " << describeReasons(verdict.reasons);
    }
  }
}

}  // namespace
}  // namespace flight_corridor
