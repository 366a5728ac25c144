#include "sim/scene_builders.hpp"
#include "sim/scene_parts.hpp"

namespace flight_corridor::sim {
namespace {

/// A person walks across, 2.5 to 3 m before a nearly hovering camera.
void intruder(Scene& scene, Random& random) {
  const double x_m = random.uniform(3.4, 3.8);
  const double side = random.sign();
  const Eigen::Vector3d velocity_W(0.0, -side * random.uniform(0.9, 1.2), 0.0);
  const Material clothes = textured(random, 0.35, 0.35, 0.2);
  Primitive body = makeCylinder({x_m, 4.0 * side, 0.0}, {x_m, 4.0 * side, 1.5}, 0.22, clothes);
  Primitive head = makeSphere({x_m, 4.0 * side, 1.65}, 0.13, textured(random, 0.55, 0.3, 0.1));
  body.velocity_W = head.velocity_W = velocity_W;
  scene.world.insert(scene.world.end(), {body, head, wallAcross(9.0, -15.0, 15.0, 6.0, masonry(random))});
  flyUntil(scene, 1.0, 0.15);
}

/// Another vehicle comes nearer at 1.5 to 3 m/s, crosses the axis 2.5 to 3 m away and passes at the side.
void oncoming(Scene& scene, Random& random) {
  constexpr double kStart_x_m = 10.0;
  const double speed_m_s = random.uniform(1.5, 3.0);
  const double crossing_x_m = random.uniform(3.0, 3.5);
  const double slope = random.eitherSign(0.5, 0.7);
  const Eigen::Vector3d start_W(kStart_x_m, middle(scene) + slope * (kStart_x_m - crossing_x_m), kHeight_m);
  Primitive hull = makeBox(start_W, {0.4, 0.4, 0.15}, textured(random, 0.25, 0.35, 0.1));
  Primitive battery = makeSphere(start_W + Eigen::Vector3d(0, 0, 0.1), 0.12, textured(random, 0.5, 0.35, 0.1));
  hull.velocity_W = battery.velocity_W = -speed_m_s * Eigen::Vector3d(1.0, slope, 0.0);
  scene.world.insert(scene.world.end(), {hull, battery, backdrop(12.0, masonry(random))});
  flyUntil(scene, 1.0, 0.15);
}

/// A box that is there for two seconds.
void appear(Scene& scene, Random& random) {
  const Eigen::Vector3d centre_W{random.uniform(3.5, 4.0), random.uniform(-0.2, 0.2), kHeight_m};
  Primitive box = makeBox(centre_W, {0.5, 0.6, 0.6}, masonry(random));
  box.visible_from_s = random.uniform(2.0, 2.6);
  box.visible_until_s = box.visible_from_s + 2.0;
  scene.world.insert(scene.world.end(), {box, wallAcross(9.0, -15.0, 15.0, 6.0, masonry(random))});
  flyUntil(scene, 1.0, 0.15);
}

/// Hovering: what stands before the camera goes away for good.
void vanish(Scene& scene, Random& random) {
  const double x_m = random.uniform(1.5, 3.6);
  const double y_m = middle(scene) + random.uniform(-0.5, 0.5);
  const double size_m = random.uniform(0.2, 0.8);
  Primitive box = makeBox({x_m + size_m / 2.0, y_m, kHeight_m}, {size_m, size_m, size_m}, masonry(random));
  box.visible_until_s = random.uniform(2.0, 3.5);
  scene.world.insert(scene.world.end(), {box, backdrop(9.0, masonry(random))});
  scene.flight.speed_m_s = 0.0;
  scene.flight.duration_s = 6.0;
}

}  // namespace

std::vector<SceneBuilder> changeBuilders() {
  return {{"appear", Visibility::Visible, appear},
          {"intruder", Visibility::Visible, intruder},
          {"oncoming", Visibility::Visible, oncoming},
          {"vanish", Visibility::Visible, vanish}};
}

}  // namespace flight_corridor::sim
