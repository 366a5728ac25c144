#include <cmath>

#include "sim/scene_builders.hpp"
#include "sim/scene_parts.hpp"

// What has nothing to match but its outline and how the light falls on it. Half of the flights are without a LiDAR.

namespace flight_corridor::sim {
namespace {

/// Paint on which only the light changes, over half a metre and more.
Material paint(Random& random) {
  const double contrast = random.uniform(0.02, 0.08);
  Material material = textured(random, random.uniform(0.35, 0.6), contrast, 4.0);
  material.finest_m = 0.5f;
  return material;
}

/// Drawn last: what was drawn before differs between families of one seed.
void maybeWithoutLidar(Scene& scene, Random& random) {
  if (random.chance(0.5)) scene.lidar.rate_hz = 0.0;
}

/// Seen aslant; what the axis meets at x is nearer on one side of the corridor.
void bareSlant(Scene& scene, Random& random) {
  const double x_m = approach(scene, random, 2.2);
  const double angle_rad = random.eitherSign(0.35, 1.05);
  scene.world.push_back(turned(makeBox({x_m, middle(scene), 2.5}, {0.3, 30.0, 5.0}, paint(random)), angle_rad));
  maybeWithoutLidar(scene, random);
}

/// A column of a house or a tank, before a wall of stone or as bare.
void bareColumn(Scene& scene, Random& random) {
  const double x_m = approach(scene, random);
  const double radius_m = random.uniform(0.15, 2.5);
  const double y_m = middle(scene) + random.uniform(-0.4, 0.4);
  scene.world.push_back(uprightPole(x_m + radius_m, y_m, radius_m, 5.0, paint(random)));
  scene.world.push_back(backdrop(x_m + 6.0, random.chance(0.5) ? masonry(random) : paint(random)));
  maybeWithoutLidar(scene, random);
}

/// Floor, ceiling and walls instead of ground and hills. @return the walls' paint.
Material bareRoom(double front_x_m, double half_width_m, double height_m, Scene& scene, Random& random) {
  const Material walls = paint(random);
  scene.world.clear();
  scene.world.push_back(makeBox({0.0, 0.0, -0.1}, {100.0, 40.0, 0.2}, paint(random)));
  scene.world.push_back(makeBox({0.0, 0.0, height_m + 0.1}, {100.0, 40.0, 0.2}, walls));
  for (const double side : {-1.0, 1.0}) {
    const double y_m = middle(scene) + side * (half_width_m + 0.1);
    scene.world.push_back(makeBox({0.0, y_m, height_m / 2.0}, {100.0, 0.2, height_m}, walls));
  }
  scene.world.push_back(wallAcross(front_x_m, -20.0, 20.0, height_m, walls));
  return walls;
}

/// Up to the wall at its end; half of them narrow before it, from one side, into the corridor.
void bareHallway(Scene& scene, Random& random) {
  flySteadily(scene);
  const double front_x_m = approach(scene, random);
  const double half_width_m = random.uniform(0.85, 1.3);
  const Material walls = bareRoom(front_x_m + 3.0, half_width_m, 2.5, scene, random);
  if (random.chance(0.5)) {
    const double near_side_m = random.uniform(0.2, 0.5), deep_m = half_width_m - near_side_m;
    const double y_m = middle(scene) + random.sign() * (near_side_m + deep_m / 2.0);
    scene.world.push_back(makeBox({front_x_m + 1.5, y_m, 1.25}, {3.0, deep_m, 2.5}, walls));
  } else {
    scene.world.push_back(wallAcross(front_x_m, -20.0, 20.0, 2.5, walls));
  }
  maybeWithoutLidar(scene, random);
}

/// The walls stay beyond the corridor: always free.
void bareHall(Scene& scene, Random& random) {
  const double front_x_m = random.uniform(9.0, 12.0);
  const double half_width_m = random.uniform(1.5, 3.0);
  bareRoom(front_x_m, half_width_m, 2.8, scene, random);
  flyUntil(scene, 4.0, random.uniform(0.8, 1.5));
  maybeWithoutLidar(scene, random);
}

/// A level bar right across the view, so that neither of its ends shows.
void bareBeam(Scene& scene, Random& random) {
  flySteadily(scene);
  const double x_m = approach(scene, random);
  const double thick_m = random.uniform(0.05, 0.25);
  const double z_m = kHeight_m + random.uniform(-0.15, 0.15);
  scene.world.push_back(makeBox({x_m + thick_m / 2.0, 0.0, z_m}, {thick_m, 30.0, thick_m}, paint(random)));
  scene.world.push_back(backdrop(x_m + 6.0, random.chance(0.5) ? masonry(random) : paint(random)));
  maybeWithoutLidar(scene, random);
}

/// A ball or a box of nearly the grey of the bare wall behind it.
void bareOnBare(Scene& scene, Random& random) {
  const double x_m = approach(scene, random);
  const Material wall = paint(random);
  Material same = wall;
  same.grey *= static_cast<float>(1.0 + random.eitherSign(0.01, 0.06));
  const double size_m = random.uniform(0.15, 0.8);
  const double y_m = middle(scene) + random.uniform(-0.4, 0.4);
  const Eigen::Vector3d middle_W(x_m + size_m / 2.0, y_m, kHeight_m + random.uniform(-0.1, 0.1));
  scene.world.push_back(random.chance(0.5) ? makeSphere(middle_W, size_m / 2.0, same)
                                           : makeBox(middle_W, Eigen::Vector3d::Constant(size_m), same));
  scene.world.push_back(backdrop(x_m + random.uniform(1.0, 5.0), wall));
  maybeWithoutLidar(scene, random);
}

/// So bright that neither camera shows anything on it.
void whiteWall(Scene& scene, Random& random) {
  addWallOf(plain(3.0), scene, random);
  maybeWithoutLidar(scene, random);
}

/// The blank wall in the light of the rig's projector: in the sun its dots drown in noise, in a dim room they are all
/// that shows.
void projector(Scene& scene, Random& random) {
  addWallOf(plain(0.55), scene, random);
  DotProjector dots;
  dots.T_C_P.translation() = Eigen::Vector3d(0.03, 0.0, 0.0);
  dots.strength = std::pow(10.0, random.uniform(-0.7, 1.3));
  dots.seed = random.word();
  scene.projector = dots;
  maybeWithoutLidar(scene, random);
}

}  // namespace

std::vector<SceneBuilder> bareBuilders() {
  return {{"bare_beam", Visibility::Unseeable, bareBeam},      {"bare_column", Visibility::Unseeable, bareColumn},
          {"bare_hall", Visibility::Unseeable, bareHall},      {"bare_hallway", Visibility::Unseeable, bareHallway},
          {"bare_on_bare", Visibility::Unseeable, bareOnBare}, {"bare_slant", Visibility::Unseeable, bareSlant},
          {"projector", Visibility::Unseeable, projector},     {"white_wall", Visibility::Unseeable, whiteWall}};
}

}  // namespace flight_corridor::sim
