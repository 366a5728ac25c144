#include <cmath>

#include "sim/scene_builders.hpp"
#include "sim/scene_parts.hpp"

namespace flight_corridor::sim {
namespace {

// One pixel is 6 mm wide at 2 m and 11 mm at 4 m. Nothing here is thinner than a pixel and a half at 4 m, and what is
// as thin as that leans: thinner and level obstacles cannot be ranged by this rig.

/// 6 cm thick, beside the beam, before a wall that stays beyond the corridor.
void pole(Scene& scene, Random& random) {
  const double beside_m = random.eitherSign(0.25, 0.4);
  scene.world.push_back(uprightPole(7.0, middle(scene) + beside_m, 0.03, 4.0, bark(random)));
  scene.world.push_back(backdrop(12.0, masonry(random)));
  flyUntil(scene, 5.7, random.uniform(0.8, 1.0));
}

/// 6 cm thick, beside the beam; from 1.2 m the camera comes to where stereo is blind.
void closePole(Scene& scene, Random& random) {
  constexpr double kRadius_m = 0.03, kStop_m = 0.15;
  const double x_m = kAhead_m + 1.2 + kRadius_m;
  const double beside_m = random.eitherSign(0.06, 0.2);
  scene.world.push_back(uprightPole(x_m, middle(scene) + beside_m, kRadius_m, 4.0, bark(random)));
  scene.world.push_back(backdrop(8.0, masonry(random)));
  flyUntil(scene, x_m - kRadius_m - kStop_m, random.uniform(0.2, 0.4));
}

/// 4 cm thick, nearly level, a little above the beam.
void branch(Scene& scene, Random& random) {
  const double z_m = kHeight_m + random.uniform(0.03, 0.08);
  const double tilt = random.eitherSign(0.04, 0.12);
  const double bend_m = random.uniform(-0.2, 0.2);
  scene.world.push_back(
      makeCylinder({7.0 - bend_m, -1.8, z_m - 1.8 * tilt}, {7.0 + bend_m, 1.8, z_m + 1.8 * tilt}, 0.02, bark(random)));
  scene.world.push_back(uprightPole(7.0 + bend_m, 1.8, 0.15, 5.0, bark(random)));
  scene.world.push_back(backdrop(12.5, masonry(random)));
  flyUntil(scene, 5.5, random.uniform(0.8, 1.0));
}

/// One to three cables, 18 to 26 mm thick, that lean by 20 to 60 degrees from the vertical.
void wire(Scene& scene, Random& random) {
  const double x_m = approach(scene, random);
  const double lean_rad = random.eitherSign(0.35, 1.05);
  const Eigen::Vector3d along_W(random.uniform(-0.2, 0.2), std::sin(lean_rad), std::cos(lean_rad));
  const double radius_m = random.uniform(0.009, 0.013);
  const Material rubber = textured(random, 0.12, 0.2, 0.16);
  const int count = 1 + static_cast<int>(random.word() % 3);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d through_W(x_m, middle(scene) + random.uniform(-0.35, 0.35), kHeight_m);
    scene.world.push_back(makeCylinder(through_W - 4.0 * along_W, through_W + 4.0 * along_W, radius_m, rubber));
  }
  scene.world.push_back(backdrop(x_m + 6.0, masonry(random)));
}

/// Ropes 16 to 22 mm thick, meshes of 0.14 to 0.25 m, across the whole path.
void net(Scene& scene, Random& random) {
  constexpr double kHalf_m = 2.5, kTop_m = 3.2;
  const double x_m = approach(scene, random);
  const double radius_m = random.uniform(0.008, 0.011);
  const double mesh_m = random.uniform(0.14, 0.25);
  const double hang_m = random.uniform(-0.15, 0.15);  // no net hangs plumb
  for (double y_m = -kHalf_m; y_m <= kHalf_m; y_m += mesh_m) {
    scene.world.push_back(makeCylinder({x_m, y_m, 0.0}, {x_m + hang_m, y_m, kTop_m}, radius_m, bark(random)));
  }
  for (double z_m = mesh_m / 2.0; z_m <= kTop_m; z_m += mesh_m) {
    const double hung_x_m = x_m + hang_m * z_m / kTop_m;
    scene.world.push_back(makeCylinder({hung_x_m, -kHalf_m, z_m}, {hung_x_m, kHalf_m, z_m}, radius_m, bark(random)));
  }
  scene.world.push_back(backdrop(x_m + 6.0, masonry(random)));
}

/// A leaf of 7 cm by 5 cm, anyhow within a crown.
Primitive leaf(const Eigen::Vector3d& crown_W, const Eigen::Vector3d& crown_half_m, Random& random) {
  const Eigen::Vector3d within{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
  const Eigen::Vector3d axis{random.normal(1.0), random.normal(1.0), random.normal(1.0)};
  Primitive leaf =
      makeBox(crown_W + crown_half_m.cwiseProduct(within), {0.07, 0.05, 0.004}, textured(random, 0.3, 0.2, 0.04));
  leaf.T_W_O.rotate(Eigen::AngleAxisd(random.uniform(0.0, M_PI), axis.normalized()));
  return leaf;
}

/// A bough with some 200 leaves, through which the wall behind is seen.
void foliage(Scene& scene, Random& random) {
  const Eigen::Vector3d half_m(0.4, 0.9, 0.5);
  const double x_m = approach(scene, random) + half_m.x();
  const Eigen::Vector3d crown_W(x_m, middle(scene) + random.uniform(-0.5, 0.5), kHeight_m);
  const int leaves = 160 + static_cast<int>(random.word() % 80);
  for (int i = 0; i < leaves; ++i) scene.world.push_back(leaf(crown_W, half_m, random));
  for (int i = 0; i < 6; ++i) {
    const double bearing_rad = random.uniform(0.0, 2.0 * M_PI);
    const Eigen::Vector3d tip_W =
        crown_W + half_m.cwiseProduct(Eigen::Vector3d(std::cos(bearing_rad), std::sin(bearing_rad), -0.8));
    scene.world.push_back(makeCylinder(tip_W, crown_W + Eigen::Vector3d(0, 0, 1.2), 0.008, bark(random)));
  }
  scene.world.push_back(uprightPole(crown_W.x(), crown_W.y() + 2.0, 0.2, 5.0, bark(random)));
  scene.world.push_back(makeCylinder(crown_W + Eigen::Vector3d(0, 2.0, 1.6), crown_W + Eigen::Vector3d(0, -0.5, 1.1),
                                     0.04, bark(random)));
  scene.world.push_back(backdrop(crown_W.x() + 6.0, masonry(random)));
}

/// Equal pickets at equal distances, each the picture of the next.
void fence(Scene& scene, Random& random) {
  const double x_m = approach(scene, random);
  const double width_m = random.uniform(0.05, 0.08);
  const double period_m = width_m + random.uniform(0.07, 0.12);
  const double height_m = random.uniform(1.7, 2.2);
  const Material wood = textured(random, 0.5, 0.25, 0.16);
  for (double y_m = -4.0; y_m <= 4.0; y_m += period_m) {
    scene.world.push_back(makeBox({x_m + 0.01, y_m, height_m / 2.0}, {0.02, width_m, height_m}, wood));
  }
  for (const double z_m : {0.4, height_m - 0.3}) {
    scene.world.push_back(makeBox({x_m + 0.04, 0.0, z_m}, {0.04, 8.0, 0.08}, wood));
  }
  scene.world.push_back(backdrop(x_m + 6.0, masonry(random)));
}

}  // namespace

std::vector<SceneBuilder> thinBuilders() {
  return {{"branch", Visibility::Visible, branch}, {"close_pole", Visibility::TooNear, closePole},
          {"fence", Visibility::Visible, fence},   {"foliage", Visibility::Visible, foliage},
          {"net", Visibility::Visible, net},       {"pole", Visibility::Visible, pole},
          {"wire", Visibility::Visible, wire}};
}

}  // namespace flight_corridor::sim
