#include <cmath>

#include "sim/scene_builders.hpp"
#include "sim/scene_parts.hpp"

namespace flight_corridor::sim {
namespace {

/// Towards the sun, ahead by so much to the left and up. Without the hills, which would hide it.
void lookIntoTheSun(double left_rad, double up_rad, double saturated_rad, Scene& scene, Random& random) {
  scene.world.clear();
  addGround(1.5, scene, random);
  scene.sun = Sun{{std::cos(up_rad) * std::cos(left_rad), std::cos(up_rad) * std::sin(left_rad), std::sin(up_rad)},
                  saturated_rad};
  scene.lidar.drop_out_share = 0.1;  // sunlight blinds it too
}

/// A trunk in the corridor and a wall beyond the corridor.
void addTrunk(Scene& scene, Random& random) {
  const double x_m = approach(scene, random);
  const double y_m = middle(scene) + random.uniform(-0.3, 0.3);
  const double radius_m = random.uniform(0.1, 0.25);
  scene.world.push_back(uprightPole(x_m + radius_m, y_m, radius_m, 5.0, bark(random)));
  scene.world.push_back(backdrop(x_m + 6.0, masonry(random)));
}

/// The sun above the wall beyond; its saturated patch stays above the corridor, its stray light does not.
void lowSun(Scene& scene, Random& random) {
  const double left_rad = random.uniform(-0.3, 0.3);
  const double up_rad = random.uniform(0.28, 0.35);
  const double saturated_rad = random.uniform(0.06, 0.1);
  lookIntoTheSun(left_rad, up_rad, saturated_rad, scene, random);
  const double x_m = approach(scene, random);
  const double y_m = middle(scene) + random.uniform(-0.4, 0.4);
  const double height_m = random.uniform(1.6, 2.0);
  scene.world.push_back(makeBox({x_m + 0.2, y_m, height_m / 2.0}, {0.4, 0.8, height_m}, masonry(random)));
  scene.world.push_back(wallAcross(x_m + 7.0, -30.0, 30.0, 3.0, masonry(random)));
}

/// The sun stands right above a low wall, and its saturated patch on the whole of the corridor.
void dazzled(Scene& scene, Random& random) {
  const double left_rad = random.uniform(-0.03, 0.03);
  const double up_rad = random.uniform(0.07, 0.1);
  lookIntoTheSun(left_rad, up_rad, random.uniform(0.3, 0.4), scene, random);
  const double x_m = approach(scene, random);
  const double height_m = kHeight_m + random.uniform(0.0, 0.08);
  scene.world.push_back(wallAcross(x_m, -6.0, 6.0, height_m, masonry(random)));
}

/// Dusk: a seventh of the light, with more noise of the electronics and, for that light, of the photons.
void lowLight(Scene& scene, Random& random) {
  for (ImageSensor* sensor : {&scene.rig.left, &scene.rig.right}) {
    sensor->gain *= 0.15;
    sensor->read_noise = 1.2;
    sensor->shot_noise = 0.05;
  }
  addTrunk(scene, random);
}

/// Shaken, with a long exposure: the image moves by up to about 4 px meanwhile.
void motionBlur(Scene& scene, Random& random) {
  scene.rig.exposure_s = random.uniform(0.02, 0.03);
  scene.flight.wobble_rad = {0.04, 0.04, 0.04};
  addTrunk(scene, random);
}

/// One camera gets up to twice the light of the other.
void exposureDifference(Scene& scene, Random& random) {
  scene.rig.right.gain *= random.chance(0.5) ? random.uniform(0.5, 0.75) : random.uniform(1.3, 1.6);
  addTrunk(scene, random);
}

void rain(Scene& scene, Random& random) {
  const int streaks = 100 + static_cast<int>(random.word() % 200);
  scene.rig.left.streaks = scene.rig.right.streaks = streaks;
  scene.lidar.drop_out_share = 0.03;
  scene.lidar.outlier_share = 0.05;
  addTrunk(scene, random);
}

/// Rolls by up to 30 degrees and pitches by up to 25, so high that the corridor does not meet the ground, before a
/// trunk and a house that fills the view also then.
void banking(Scene& scene, Random& random) {
  scene.flight.wobble_rad = {0.52, 0.44, 0.05};
  scene.flight.start_W.z() = 2.3;
  addTrunk(scene, random);
  scene.world.back() = wallAcross(scene.world.back().T_W_O.translation().x(), -20.0, 20.0, 20.0, masonry(random));
}

}  // namespace

std::vector<SceneBuilder> seeingBuilders() {
  return {{"banking", Visibility::Visible, banking},
          {"dazzled", Visibility::Unseeable, dazzled},
          {"exposure_difference", Visibility::Visible, exposureDifference},
          {"low_light", Visibility::Visible, lowLight},
          {"low_sun", Visibility::Visible, lowSun},
          {"motion_blur", Visibility::Visible, motionBlur},
          {"rain", Visibility::Visible, rain}};
}

}  // namespace flight_corridor::sim
