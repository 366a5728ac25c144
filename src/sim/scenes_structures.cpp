#include <cmath>

#include "sim/scene_builders.hpp"
#include "sim/scene_parts.hpp"

namespace flight_corridor::sim {
namespace {

/// Seen aslant; what the axis meets at x is nearer on one side of the corridor.
void slantedWall(Scene& scene, Random& random) {
  const double x_m = approach(scene, random, 2.2);
  const double angle_rad = random.eitherSign(0.4, 1.0);
  scene.world.push_back(turned(makeBox({x_m, middle(scene), 2.5}, {0.3, 30.0, 5.0}, masonry(random)), angle_rad));
}

/// The edge of a house, both of its walls going away; the edge itself stands in the corridor.
void corner(Scene& scene, Random& random) {
  constexpr double kHouse_m = 8.0;
  const double x_m = approach(scene, random);
  const Eigen::Vector3d edge_W(x_m, middle(scene) + random.uniform(-0.4, 0.4), 0.0);
  Primitive house = makeBox(edge_W, {kHouse_m, kHouse_m, 5.0}, masonry(random));
  house.T_W_O.rotate(Eigen::AngleAxisd(random.uniform(0.5, 1.07), Eigen::Vector3d::UnitZ()));
  house.T_W_O.translate(Eigen::Vector3d(kHouse_m / 2.0, -kHouse_m / 2.0, 2.5));
  scene.world.push_back(house);
}

void wallWithGap(double x_m, double gap_m, Scene& scene, Random& random) {
  scene.world.push_back(wallAcross(x_m, middle(scene) + gap_m / 2.0, middle(scene) + 6.0, 3.5, masonry(random)));
  scene.world.push_back(wallAcross(x_m, middle(scene) - 6.0, middle(scene) - gap_m / 2.0, 3.5, masonry(random)));
  scene.world.push_back(backdrop(x_m + 8.0, masonry(random)));
}

/// Wide enough for the whole flight, which leads through it: always free.
void wideGap(Scene& scene, Random& random) {
  wallWithGap(6.0, random.uniform(2.2, 2.6), scene, random);
  flyUntil(scene, 7.0, random.uniform(0.9, 1.2));
}

/// Narrower than the corridor; the beam passes through it.
void narrowGap(Scene& scene, Random& random) {
  wallWithGap(7.0, random.uniform(0.6, 0.85), scene, random);
  flyUntil(scene, 5.6, random.uniform(0.8, 1.0));
}

/// Pairs of trunks and boxes whose near sides stay more than 0.10 m outside the corridor: always free.
void sideObstacles(Scene& scene, Random& random) {
  scene.flight.wobble_rad = {0.03, 0.015, 0.01};
  for (const double x_m : {2.5, 4.0, 5.5, 7.0, 8.5, 10.0}) {
    for (const double side : {-1.0, 1.0}) {
      const double near_side_m = middle(scene) + side * random.uniform(0.82, 0.95);
      const double half_m = random.uniform(0.05, 0.25);
      const double y_m = near_side_m + side * half_m;
      const double height_m = random.uniform(1.6, 3.0);
      scene.world.push_back(random.chance(0.5) ? uprightPole(x_m, y_m, half_m, height_m, bark(random))
                                               : makeBox({x_m, y_m, height_m / 2.0},
                                                         {2.0 * half_m, 2.0 * half_m, height_m}, masonry(random)));
    }
  }
  scene.world.push_back(backdrop(13.0, masonry(random)));
  flyUntil(scene, 7.0, random.uniform(0.9, 1.1));
}

enum Side { Left, Right, Above, Below };

/// Something large whose near side stands so far outside one side of the corridor; negative: inside.
Primitive besideCorridor(Side side, double x_m, double outside_m, const Scene& scene, const Material& material) {
  constexpr double kThick_m = 0.5;
  const double across_m = kHalfWidth_m + outside_m + kThick_m / 2.0;
  const double upwards_m = kHalfHeight_m + outside_m;
  switch (side) {
    case Left:
      return makeBox({x_m, middle(scene) + across_m, 1.25}, {kThick_m, kThick_m, 2.5}, material);
    case Right:
      return makeBox({x_m, middle(scene) - across_m, 1.25}, {kThick_m, kThick_m, 2.5}, material);
    case Above:
      return makeBox({x_m, 0.0, kHeight_m + upwards_m + 0.5}, {kThick_m, 4.0, 1.0}, material);
    case Below:
      break;
  }
  const double top_m = kHeight_m - upwards_m;
  return makeBox({x_m, 0.0, top_m / 2.0}, {kThick_m, 4.0, top_m}, material);
}

/// Posts, lintels and low walls 0.12 to 0.25 m outside each side of the corridor: always free.
void justOutside(Scene& scene, Random& random) {
  flySteadily(scene);
  for (const double x_m : {3.5, 5.5, 7.5}) {
    for (const Side side : {Left, Right, Above, Below}) {
      const double outside_m = random.uniform(0.12, 0.25);
      scene.world.push_back(besideCorridor(side, x_m, outside_m, scene, masonry(random)));
    }
  }
  scene.world.push_back(backdrop(13.0, masonry(random)));
  flyUntil(scene, 7.0, random.uniform(0.5, 3.0));
}

/// The same, one of them reaching 0.03 to 0.10 m in.
void justInside(Scene& scene, Random& random) {
  flySteadily(scene);
  const double x_m = approach(scene, random);
  const Side inner = static_cast<Side>(random.word() % 4);
  for (const Side side : {Left, Right, Above, Below}) {
    const double outside_m = side == inner ? -random.uniform(0.03, 0.10) : random.uniform(0.15, 0.3);
    scene.world.push_back(besideCorridor(side, x_m + 0.25, outside_m, scene, masonry(random)));
  }
  scene.world.push_back(backdrop(x_m + 6.0, masonry(random)));
}

/// A beam of a house that hangs into the corridor from above; the LiDAR looks below it.
void overhang(Scene& scene, Random& random) {
  const double underside_m = kHeight_m + random.uniform(0.04, 0.09);
  scene.world.push_back(makeBox({7.2, 0.0, underside_m + 0.6}, {0.4, 5.0, 1.2}, masonry(random)));
  scene.world.push_back(wallAcross(12.5, -15.0, 15.0, 6.0, masonry(random)));
  scene.flight.wobble_rad.y() = 0.01;
  flyUntil(scene, 5.5, random.uniform(0.8, 1.0));
}

/// Over ground 0.15 to 0.4 m below the corridor, towards a kerb that reaches into it.
void lowGround(Scene& scene, Random& random) {
  flySteadily(scene);
  scene.flight.start_W.z() = random.uniform(0.35, 0.6);
  const double x_m = approach(scene, random);
  const double kerb_m = scene.flight.start_W.z() - kHalfHeight_m + random.uniform(0.05, 0.15);
  scene.world.push_back(makeBox({x_m + 0.2, 0.0, kerb_m / 2.0}, {0.4, 6.0, kerb_m}, masonry(random)));
  scene.world.push_back(backdrop(x_m + 6.0, masonry(random)));
}

/// Ground that rises ahead, by 12 to 30 degrees.
void slope(Scene& scene, Random& random) {
  const double angle_rad = random.uniform(0.21, 0.52);
  const double foot_x_m = approach(scene, random) - (kHeight_m - kHalfHeight_m) / std::tan(angle_rad);
  Primitive hill = makeBox({foot_x_m, 0.0, 0.0}, {60.0, 120.0, 20.0}, textured(random, 0.4, 0.25, 1.5));
  hill.T_W_O.rotate(Eigen::AngleAxisd(-angle_rad, Eigen::Vector3d::UnitY()));
  hill.T_W_O.translate(Eigen::Vector3d(28.0, 0.0, -10.0));  // its upper face meets the ground at the foot
  scene.world.push_back(hill);
}

/// A ball or a box of 10 to 25 cm that hangs in the corridor, beside the beam: a lamp, a nesting box.
void smallObstacle(Scene& scene, Random& random) {
  const double x_m = approach(scene, random);
  const double size_m = random.uniform(0.1, 0.25);
  const double beside_m = random.eitherSign(0.2, 0.45);
  const double above_m = random.uniform(-0.1, 0.1);
  const double grey = random.uniform(0.15, 0.8);
  const double contrast = random.uniform(0.1, 0.35);
  const Material paint = textured(random, grey, contrast, 0.16);
  const Eigen::Vector3d middle_W(x_m + size_m / 2.0, middle(scene) + beside_m, kHeight_m + above_m);
  scene.world.push_back(random.chance(0.5) ? makeSphere(middle_W, size_m / 2.0, paint)
                                           : makeBox(middle_W, Eigen::Vector3d::Constant(size_m), paint));
  scene.world.push_back(backdrop(x_m + 6.0, masonry(random)));
}

}  // namespace

std::vector<SceneBuilder> structureBuilders() {
  return {{"corner", Visibility::Visible, corner},
          {"just_inside", Visibility::Visible, justInside},
          {"just_outside", Visibility::Visible, justOutside},
          {"low_ground", Visibility::Visible, lowGround},
          {"narrow_gap", Visibility::Visible, narrowGap},
          {"overhang", Visibility::Visible, overhang},
          {"side_obstacles", Visibility::Visible, sideObstacles},
          {"slanted_wall", Visibility::Visible, slantedWall},
          {"slope", Visibility::Visible, slope},
          {"small_thing", Visibility::Visible, smallObstacle},
          {"wall", Visibility::Visible, addWall},
          {"wide_gap", Visibility::Visible, wideGap}};
}

}  // namespace flight_corridor::sim
