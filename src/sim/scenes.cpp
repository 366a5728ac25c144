#include "sim/scenes.hpp"

#include <cmath>
#include <map>
#include <stdexcept>

#include "sim/random.hpp"

namespace flight_corridor::sim {
namespace {

// The flight starts above W's origin, flies along +x, 1.5 m above ground; the camera is 0.10 m ahead of the body.
constexpr double kHeight_m = 1.5;
constexpr double kAhead_m = 0.10;

// At most one argument of a call draws from Random: C++ leaves the order of arguments open, a seed must not.

Material textured(Random& random, double grey, double contrast, double coarsest_m) {
  Material material;
  material.grey = static_cast<float>(grey * random.uniform(0.7, 1.3));
  material.contrast = static_cast<float>(contrast);
  material.coarsest_m = static_cast<float>(coarsest_m);
  material.seed = random.word();
  return material;
}

Material masonry(Random& random) { return textured(random, 0.5, 0.30, 0.6); }
Material bark(Random& random) { return textured(random, 0.25, 0.35, 0.16); }
Material plain(double grey) {
  Material material;
  material.grey = static_cast<float>(grey);
  material.contrast = 0.0f;
  return material;
}

/// Wall across the flight, its near face at x.
Primitive wallAcross(double x_m, double y_right_m, double y_left_m, double height_m, const Material& material) {
  constexpr double kThick_m = 0.3;
  return makeBox({x_m + kThick_m / 2.0, (y_left_m + y_right_m) / 2.0, height_m / 2.0},
                 {kThick_m, y_left_m - y_right_m, height_m}, material);
}

Primitive uprightPole(double x_m, double y_m, double radius_m, double height_m, const Material& material) {
  return makeCylinder({x_m, y_m, 0.0}, {x_m, y_m, height_m}, radius_m, material);
}

void addGround(double coarsest_m, Scene& scene, Random& random) {
  scene.world.push_back(makeBox({0, 0, -0.5}, {300, 300, 1}, textured(random, 0.4, 0.25, coarsest_m)));
}

/// Hills or houses, 30 to 45 m away all around.
void addSurroundings(Scene& scene, Random& random) {
  constexpr int kCount = 16;
  for (int i = 0; i < kCount; ++i) {
    const double bearing_rad = 2.0 * M_PI * i / kCount;
    const double distance_m = random.uniform(30.0, 45.0);
    const double height_m = random.uniform(6.0, 14.0);
    Primitive block = makeBox(Eigen::Vector3d::Zero(), {6.0, 24.0, 2.0 * height_m}, textured(random, 0.4, 0.30, 8.0));
    block.T_W_O.rotate(Eigen::AngleAxisd(bearing_rad, Eigen::Vector3d::UnitZ()));
    block.T_W_O.translate(Eigen::Vector3d(distance_m, 0.0, 0.0));
    scene.world.push_back(block);
  }
}

/// Flies until the camera stands at x.
void flyUntil(Scene& scene, double x_m, double speed_m_s) {
  scene.flight.speed_m_s = speed_m_s;
  scene.flight.duration_s = durationOver(x_m - kAhead_m, speed_m_s, scene.flight.ramp_s);
}

void wallWith(const Material& material, Scene& scene, Random& random) {
  const double wall_x_m = kAhead_m + random.uniform(7.8, 8.3);
  scene.world.push_back(wallAcross(wall_x_m, -12.0, 12.0, 5.0, material));
  flyUntil(scene, wall_x_m - 1.5, random.uniform(0.9, 1.1));
}

void wall(Scene& scene, Random& random) { wallWith(masonry(random), scene, random); }
void blankWall(Scene& scene, Random& random) { wallWith(plain(0.55), scene, random); }

void checkerWall(Scene& scene, Random& random) {
  Material material = textured(random, 0.5, 0.04, 0.3);
  material.checker_period_m = 0.4f;
  wallWith(material, scene, random);
}

/// The LiDAR gets nothing back, the camera sees it well.
void darkWall(Scene& scene, Random& random) {
  Material material = textured(random, 0.2, 0.35, 0.6);
  material.lidar_return = LidarReturn::Absorbed;
  wallWith(material, scene, random);
}

/// The camera sees through it to a wall behind, the LiDAR does not.
void glass(Scene& scene, Random& random) {
  Material pane = plain(0.5);
  pane.camera_sees = false;
  wallWith(pane, scene, random);
  scene.world.push_back(wallAcross(12.5, -15.0, 15.0, 6.0, masonry(random)));
}

void miscalibrated(Scene& scene, Random& random) {
  wall(scene, random);
  scene.rig.baseline_error = random.eitherSign(0.03, 0.06);
  scene.rig.disparity_offset_px = random.eitherSign(0.2, 0.5);
  scene.rig.vertical_shift_px = random.uniform(-0.2, 0.2);
}

void wallWithGap(double x_m, double gap_m, Scene& scene, Random& random) {
  const double middle_m = scene.rig.T_B_C.translation().y();
  scene.world.push_back(wallAcross(x_m, middle_m + gap_m / 2.0, middle_m + 6.0, 3.5, masonry(random)));
  scene.world.push_back(wallAcross(x_m, middle_m - 6.0, middle_m - gap_m / 2.0, 3.5, masonry(random)));
  scene.world.push_back(wallAcross(x_m + 8.0, -15.0, 15.0, 6.0, masonry(random)));
}

/// Wide enough for the whole flight, which leads through it.
void wideGap(Scene& scene, Random& random) {
  wallWithGap(6.0, random.uniform(2.2, 2.6), scene, random);
  flyUntil(scene, 7.0, random.uniform(0.9, 1.2));
}

/// Narrower than the corridor; the beam passes through it.
void narrowGap(Scene& scene, Random& random) {
  wallWithGap(7.0, random.uniform(0.6, 0.85), scene, random);
  flyUntil(scene, 5.6, random.uniform(0.8, 1.0));
}

/// 6 cm thick, beside the beam, before a wall that stays beyond the corridor.
void pole(Scene& scene, Random& random) {
  const double beside_m = random.eitherSign(0.25, 0.4);
  scene.world.push_back(uprightPole(7.0, scene.rig.T_B_C.translation().y() + beside_m, 0.03, 4.0, bark(random)));
  scene.world.push_back(wallAcross(12.0, -15.0, 15.0, 6.0, masonry(random)));
  flyUntil(scene, 5.7, random.uniform(0.8, 1.0));
}

/// 4 cm thick, nearly level, a little above the beam.
void branch(Scene& scene, Random& random) {
  const double z_m = kHeight_m + random.uniform(0.03, 0.08);
  const double tilt = random.eitherSign(0.04, 0.12);
  const double bend_m = random.uniform(-0.2, 0.2);
  scene.world.push_back(
      makeCylinder({7.0 - bend_m, -1.8, z_m - 1.8 * tilt}, {7.0 + bend_m, 1.8, z_m + 1.8 * tilt}, 0.02, bark(random)));
  scene.world.push_back(uprightPole(7.0 + bend_m, 1.8, 0.15, 5.0, bark(random)));
  scene.world.push_back(wallAcross(12.5, -15.0, 15.0, 6.0, masonry(random)));
  flyUntil(scene, 5.5, random.uniform(0.8, 1.0));
}

/// Pairs of trunks and boxes whose near sides stay more than 0.10 m outside the corridor.
void sideObstacles(Scene& scene, Random& random) {
  scene.flight.wobble_rad = {0.03, 0.015, 0.01};
  for (const double x_m : {2.5, 4.0, 5.5, 7.0, 8.5, 10.0}) {
    for (const double side : {-1.0, 1.0}) {
      const double near_side_m = scene.rig.T_B_C.translation().y() + side * random.uniform(0.82, 0.95);
      const double half_m = random.uniform(0.05, 0.25);
      const double y_m = near_side_m + side * half_m;
      const double height_m = random.uniform(1.6, 3.0);
      scene.world.push_back(random.chance(0.5) ? uprightPole(x_m, y_m, half_m, height_m, bark(random))
                                               : makeBox({x_m, y_m, height_m / 2.0},
                                                         {2.0 * half_m, 2.0 * half_m, height_m}, masonry(random)));
    }
  }
  scene.world.push_back(wallAcross(13.0, -15.0, 15.0, 6.0, masonry(random)));
  flyUntil(scene, 7.0, random.uniform(0.9, 1.1));
}

/// A beam of a house that hangs into the corridor from above; the LiDAR looks below it.
void overhang(Scene& scene, Random& random) {
  const double underside_m = kHeight_m + random.uniform(0.04, 0.09);
  scene.world.push_back(makeBox({7.2, 0.0, underside_m + 0.6}, {0.4, 5.0, 1.2}, masonry(random)));
  scene.world.push_back(wallAcross(12.5, -15.0, 15.0, 6.0, masonry(random)));
  scene.flight.wobble_rad.y() = 0.01;
  flyUntil(scene, 5.5, random.uniform(0.8, 1.0));
}

/// High above ground, nothing else.
void openSky(Scene& scene, Random& random) {
  scene.world.clear();
  addGround(12.0, scene, random);
  scene.flight.start_W.z() = random.uniform(15.0, 25.0);
  flyUntil(scene, 20.0, random.uniform(2.8, 3.2));
}

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

/// A box that is there for two seconds.
void appear(Scene& scene, Random& random) {
  const Eigen::Vector3d centre_W{random.uniform(3.5, 4.0), random.uniform(-0.2, 0.2), kHeight_m};
  Primitive box = makeBox(centre_W, {0.5, 0.6, 0.6}, masonry(random));
  box.visible_from_s = random.uniform(2.0, 2.6);
  box.visible_until_s = box.visible_from_s + 2.0;
  scene.world.insert(scene.world.end(), {box, wallAcross(9.0, -15.0, 15.0, 6.0, masonry(random))});
  flyUntil(scene, 1.0, 0.15);
}

/// Trunks everywhere but on the first metres of the way, which ends at one of them.
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

using Build = void (*)(Scene&, Random&);

const std::map<std::string, Build>& builders() {
  static const std::map<std::string, Build> kBuilders{{"appear", appear},
                                                      {"blank_wall", blankWall},
                                                      {"branch", branch},
                                                      {"checker_wall", checkerWall},
                                                      {"dark_wall", darkWall},
                                                      {"forest", forest},
                                                      {"glass", glass},
                                                      {"intruder", intruder},
                                                      {"miscalibrated", miscalibrated},
                                                      {"narrow_gap", narrowGap},
                                                      {"open_sky", openSky},
                                                      {"overhang", overhang},
                                                      {"pole", pole},
                                                      {"side_obstacles", sideObstacles},
                                                      {"wall", wall},
                                                      {"wide_gap", wideGap}};
  return kBuilders;
}

}  // namespace

std::vector<std::string> sceneNames() {
  std::vector<std::string> names;
  for (const auto& [name, build] : builders()) names.push_back(name);
  return names;
}

Scene makeScene(const std::string& name, std::uint64_t seed) {
  const auto found = builders().find(name);
  if (found == builders().end()) {
    std::string known;
    for (const std::string& scene : sceneNames()) known += " " + scene;
    throw std::invalid_argument("unknown scene '" + name + "'; known are:" + known);
  }
  Random random(seed, Stream::Scene);
  Scene scene;
  scene.rig = defaultRig();
  scene.rig.left.gain = random.uniform(210.0, 290.0);  // from 250 the sky is saturated
  scene.rig.right.gain = scene.rig.left.gain * random.uniform(0.93, 1.07);
  scene.rig.right.black_level += random.uniform(-2.0, 2.0);
  scene.flight.phase_rad = random.uniform(0.0, 2.0 * M_PI);
  addGround(1.5, scene, random);
  addSurroundings(scene, random);
  found->second(scene, random);
  return scene;
}

}  // namespace flight_corridor::sim
