#include "sim/scene_builders.hpp"
#include "sim/scene_parts.hpp"

namespace flight_corridor::sim {
namespace {

/// Trunks everywhere but on the first metres of the path, which ends at one of them.
void forest(Scene& scene, Random& random) {
  constexpr double kLane_m = 1.3;
  const double last_x_m = random.uniform(6.5, 7.5);
  const double last_y_m = random.uniform(-0.4, 0.4);
  const double last_radius_m = random.uniform(0.08, 0.25);
  scene.world.push_back(uprightPole(last_x_m, last_y_m, last_radius_m, 8.0, bark(random)));
  for (int i = 0; i < 40; ++i) {
    const double x_m = random.uniform(1.0, 22.0);
    const double y_m = random.eitherSign(x_m < last_x_m ? kLane_m : 0.0, 9.0);
    const double radius_m = random.uniform(0.06, 0.25);
    const Eigen::Vector3d root(x_m, y_m, 0.0);
    const Eigen::Vector3d lean{random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 8.0};
    scene.world.push_back(makeCylinder(root, root + lean, radius_m, bark(random)));
  }
  flyUntil(scene, last_x_m - 1.5, random.uniform(0.75, 1.0));
}

/// Floor, ceiling and four walls instead of ground and hills.
void buildRoom(double front_x_m, double half_width_m, double height_m, Scene& scene, Random& random) {
  constexpr double kBack_x_m = -2.0, kThick_m = 0.2;
  const double length_m = front_x_m - kBack_x_m;
  const Eigen::Vector3d middle_W(kBack_x_m + length_m / 2.0, middle(scene), height_m / 2.0);
  scene.world.clear();
  for (const double side : {-1.0, 1.0}) {
    const auto slab = [&](int axis, const Material& material) {
      Eigen::Vector3d size_m(length_m, 2.0 * half_width_m, height_m);
      Eigen::Vector3d centre_W = middle_W;
      centre_W[axis] += side * (size_m[axis] + kThick_m) / 2.0;
      size_m[axis] = kThick_m;
      scene.world.push_back(makeBox(centre_W, size_m, material));
    };
    slab(0, textured(random, 0.55, 0.2, 0.3));
    slab(1, textured(random, 0.55, 0.2, 0.3));
    slab(2, textured(random, 0.5, 0.25, 0.6));
  }
}

/// Cupboards and shelves along both walls.
void furnish(double front_x_m, double half_width_m, Scene& scene, Random& random) {
  for (double x_m = 1.0; x_m < front_x_m - 1.0; x_m += random.uniform(1.0, 2.5)) {
    const double side = random.sign();
    const double deep_m = random.uniform(0.3, 0.8);
    const double height_m = random.uniform(0.5, 2.2);
    const double y_m = middle(scene) + side * (half_width_m - deep_m / 2.0);
    const double wide_m = random.uniform(0.4, 1.5);
    scene.world.push_back(
        makeBox({x_m, y_m, height_m / 2.0}, {wide_m, deep_m, height_m}, textured(random, 0.4, 0.3, 0.3)));
  }
}

/// A cupboard, a lamp that hangs from the ceiling, or a door that stands open.
void standInTheWay(double x_m, double ceiling_m, Scene& scene, Random& random) {
  const double y_m = middle(scene) + random.uniform(-0.35, 0.35);
  const Material wood = textured(random, 0.4, 0.3, 0.2);
  switch (random.word() % 3) {
    case 0:
      scene.world.push_back(makeBox({x_m + 0.25, y_m, 0.95}, {0.5, 0.9, 1.9}, wood));
      break;
    case 1:
      scene.world.push_back(makeSphere({x_m + 0.2, y_m, kHeight_m + 0.05}, 0.2, wood));
      scene.world.push_back(makeCylinder({x_m + 0.2, y_m, kHeight_m}, {x_m + 0.2, y_m, ceiling_m}, 0.01, wood));
      break;
    default:
      scene.world.push_back(
          turned(makeBox({x_m + 0.3, y_m, 1.0}, {0.04, 0.8, 2.0}, wood), random.eitherSign(0.2, 0.8)));
  }
}

/// Indoors, furniture at the sides, an obstacle in the corridor.
void room(Scene& scene, Random& random) {
  const double half_width_m = random.uniform(2.0, 3.0);
  const double height_m = random.uniform(2.4, 3.0);
  const double x_m = approach(scene, random);
  const double front_x_m = x_m + random.uniform(2.0, 5.0);
  buildRoom(front_x_m, half_width_m, height_m, scene, random);
  furnish(front_x_m, half_width_m, scene, random);
  standInTheWay(x_m, height_m, scene, random);
}

/// A passage 1.7 to 2.2 m wide, up to the wall at its end; flat doors in its sides.
void hallway(Scene& scene, Random& random) {
  flySteadily(scene);
  const double half_width_m = random.uniform(0.85, 1.1);
  const double front_x_m = approach(scene, random);
  buildRoom(front_x_m, half_width_m, random.uniform(2.2, 2.6), scene, random);
  for (double x_m = 1.0; x_m < front_x_m - 1.0; x_m += random.uniform(1.5, 3.0)) {
    const double y_m = middle(scene) + random.sign() * half_width_m;
    scene.world.push_back(makeBox({x_m, y_m, 1.0}, {0.9, 0.06, 2.0}, textured(random, 0.4, 0.3, 0.2)));
  }
}

}  // namespace

std::vector<SceneBuilder> placeBuilders() {
  return {{"forest", Visibility::Visible, forest},
          {"hallway", Visibility::Visible, hallway},
          {"room", Visibility::Visible, room}};
}

}  // namespace flight_corridor::sim
