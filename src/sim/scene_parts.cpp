#include "sim/scene_parts.hpp"

#include <cmath>

namespace flight_corridor::sim {

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

Primitive wallAcross(double x_m, double y_right_m, double y_left_m, double height_m, const Material& material) {
  constexpr double kThick_m = 0.3;
  return makeBox({x_m + kThick_m / 2.0, (y_left_m + y_right_m) / 2.0, height_m / 2.0},
                 {kThick_m, y_left_m - y_right_m, height_m}, material);
}

Primitive backdrop(double x_m, const Material& material) { return wallAcross(x_m, -15.0, 15.0, 6.0, material); }

Primitive uprightPole(double x_m, double y_m, double radius_m, double height_m, const Material& material) {
  return makeCylinder({x_m, y_m, 0.0}, {x_m, y_m, height_m}, radius_m, material);
}

Primitive turned(Primitive primitive, double angle_rad) {
  primitive.T_W_O.rotate(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()));
  return primitive;
}

void addGround(double coarsest_m, Scene& scene, Random& random) {
  scene.world.push_back(makeBox({0, 0, -0.5}, {300, 300, 1}, textured(random, 0.4, 0.25, coarsest_m)));
}

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

double middle(const Scene& scene) { return scene.rig.T_B_C.translation().y(); }

void flySteadily(Scene& scene) {
  scene.flight.wobble_rad = {0.004, 0.002, 0.002};
  scene.flight.sway_m = {0.01, 0.006, 0.006};
}

void flyUntil(Scene& scene, double x_m, double speed_m_s) {
  scene.flight.speed_m_s = speed_m_s;
  scene.flight.duration_s = durationOver(x_m - kAhead_m, speed_m_s, scene.flight.ramp_s);
}

double approach(Scene& scene, Random& random, double stop_m) {
  const double speed_m_s = random.uniform(0.7, 4.0);
  const double x_m = kAhead_m + 6.5 + 1.2 * speed_m_s;  // two seconds and more before the corridor's end meets it
  flyUntil(scene, x_m - stop_m, speed_m_s);
  return x_m;
}

void addWall(Scene& scene, Random& random) { addWallOf(masonry(random), scene, random); }

void addWallOf(const Material& material, Scene& scene, Random& random) {
  const double wall_x_m = kAhead_m + random.uniform(7.8, 8.3);
  scene.world.push_back(wallAcross(wall_x_m, -12.0, 12.0, 5.0, material));
  flyUntil(scene, wall_x_m - 1.5, random.uniform(0.9, 1.1));
}

}  // namespace flight_corridor::sim
