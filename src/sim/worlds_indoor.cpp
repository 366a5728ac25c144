#include <cmath>

#include "sim/scene_parts.hpp"
#include "sim/world_builders.hpp"

namespace flight_corridor::sim {
namespace {

constexpr double kThick_m = 0.2;  // of walls

Material plaster(Random& random) { return textured(random, 0.55, 0.2, 0.3); }

/// Walls that are painted: little more than the cameras' noise.
Material wallPaint(Random& random) { return textured(random, 0.55, 0.04, 0.3); }

/// Floor, ceiling and four walls from behind the start to behind the goal.
void addHall(double half_width_m, double height_m, World& world, Random& random,
             Material (*surface)(Random&) = plaster) {
  world.ground_W = {Eigen::Vector2d(-2.0, -half_width_m), Eigen::Vector2d(26.0, half_width_m)};
  const Eigen::Vector2d middle_W = world.ground_W.center();
  const Eigen::Vector3d size_m(world.ground_W.sizes().x(), 2.0 * half_width_m, height_m);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Eigen::Vector3d centre_W(middle_W.x(), middle_W.y(), height_m / 2.0), slab_m = size_m;
      centre_W[axis] += side * (size_m[axis] + kThick_m) / 2.0;
      slab_m[axis] = kThick_m;
      world.scene.world.push_back(makeBox(centre_W, slab_m, surface(random)));
    }
  }
}

/// An opening in a wall across the hall.
struct Opening {
  double y_m, width_m, sill_m, top_m;
};

void addWallWith(const Opening& opening, double x_m, double half_width_m, double height_m, World& world,
                 Random& random) {
  const Material material = masonry(random);
  const auto piece = [&](double right_m, double left_m, double low_m, double high_m) {
    if (right_m >= left_m || low_m >= high_m) return;
    world.scene.world.push_back(makeBox({x_m, (right_m + left_m) / 2.0, (low_m + high_m) / 2.0},
                                        {kThick_m, left_m - right_m, high_m - low_m}, material));
  };
  const double right_m = opening.y_m - opening.width_m / 2.0, left_m = opening.y_m + opening.width_m / 2.0;
  piece(-half_width_m, right_m, 0.0, height_m);
  piece(left_m, half_width_m, 0.0, height_m);
  piece(right_m, left_m, 0.0, opening.sill_m);
  piece(right_m, left_m, opening.top_m, height_m);
}

/// A long hall, 5 to 7 m wide, with pillars.
void addHallWithPillars(Material (*surface)(Random&), World& world, Random& random) {
  const double half_width_m = random.uniform(2.5, 3.5);
  const double height_m = random.uniform(2.8, 3.5);
  addHall(half_width_m, height_m, world, random, surface);
  world.goal_W.y() *= 0.5;
  for (double x_m = 3.0; x_m < world.goal_W.x() - 2.0; x_m += random.uniform(1.6, 3.0)) {
    const double y_m = random.uniform(-half_width_m, half_width_m);
    const double half_m = random.uniform(0.12, 0.35);
    world.scene.world.push_back(random.chance(0.5) ? uprightPole(x_m, y_m, half_m, height_m, masonry(random))
                                                   : makeBox({x_m, y_m, height_m / 2.0},
                                                             {2.0 * half_m, 2.0 * half_m, height_m}, masonry(random)));
  }
}

void pillars(World& world, Random& random) { addHallWithPillars(plaster, world, random); }
void paintedHall(World& world, Random& random) { addHallWithPillars(wallPaint, world, random); }

constexpr double kHalfWidth_m = 5.0, kTall_m = 3.5;  // of the hall with gates or doors

/// Walls across, 5 to 6.5 m apart, with a gate or a window each.
void gates(World& world, Random& random) {
  addHall(kHalfWidth_m, kTall_m, world, random);
  for (double x_m = random.uniform(4.5, 6.0); x_m < world.goal_W.x() - 2.5; x_m += random.uniform(5.0, 6.5)) {
    Opening opening{random.uniform(-2.0, 2.0), random.uniform(1.7, 2.6), 0.0, kTall_m};
    if (random.chance(0.6)) {
      opening.sill_m = kHeight_m - random.uniform(0.5, 0.8);
      opening.top_m = kHeight_m + random.uniform(0.5, 0.8);
    }
    addWallWith(opening, x_m, kHalfWidth_m, kTall_m, world, random);
  }
}

/// Walls across, 5 to 6.5 m apart, with a door 1.6 to 1.9 m wide each.
void doors(World& world, Random& random) {
  addHall(kHalfWidth_m, kTall_m, world, random);
  for (double x_m = random.uniform(4.5, 6.0); x_m < world.goal_W.x() - 2.5; x_m += random.uniform(5.0, 6.5)) {
    const double y_m = random.uniform(-2.5, 2.5);
    const double width_m = random.uniform(1.6, 1.9);
    addWallWith({y_m, width_m, 0.0, 2.2}, x_m, kHalfWidth_m, kTall_m, world, random);
  }
}

/// Furniture along the walls and in the room, and lamps that hang from the ceiling.
void furnish(double half_width_m, double height_m, World& world, Random& random) {
  const auto wood = [&] { return textured(random, 0.4, 0.3, 0.25); };
  for (double x_m = 2.5; x_m < world.goal_W.x() - 2.0; x_m += random.uniform(1.2, 2.5)) {
    const double side = random.sign();
    const double deep_m = random.uniform(0.3, 0.8);
    const double tall_m = random.uniform(0.6, 2.1);
    world.scene.world.push_back(makeBox({x_m, side * (half_width_m - deep_m / 2.0), tall_m / 2.0},
                                        {random.uniform(0.5, 1.5), deep_m, tall_m}, wood()));
  }
  for (int i = 0; i < 5; ++i) {
    const double x_m = random.uniform(2.5, world.goal_W.x() - 2.0);
    const double y_m = random.uniform(-half_width_m + 1.0, half_width_m - 1.0);
    if (random.chance(0.4)) {
      const double z_m = random.uniform(1.5, 2.2);
      world.scene.world.push_back(makeSphere({x_m, y_m, z_m}, random.uniform(0.12, 0.2), wood()));
      world.scene.world.push_back(makeCylinder({x_m, y_m, z_m}, {x_m, y_m, height_m}, 0.01, wood()));
    } else {
      const double tall_m = random.uniform(0.8, 1.9);
      world.scene.world.push_back(makeBox({x_m, y_m, tall_m / 2.0}, {0.6, random.uniform(0.5, 1.2), tall_m}, wood()));
    }
  }
}

/// Rooms one behind the other, 5 to 7 m long, a door 1.7 to 2.2 m wide from each to the next.
void rooms(World& world, Random& random) {
  const double half_width_m = random.uniform(3.0, 4.0);
  const double height_m = random.uniform(2.5, 2.9);
  addHall(half_width_m, height_m, world, random);
  furnish(half_width_m, height_m, world, random);
  for (double x_m = random.uniform(5.0, 7.0); x_m < world.goal_W.x() - 2.5; x_m += random.uniform(5.0, 7.0)) {
    const double width_m = random.uniform(1.7, 2.2);
    const double y_m = random.uniform(-1.0, 1.0) * (half_width_m - 1.5);
    addWallWith({y_m, width_m, 0.0, 2.2}, x_m, half_width_m, height_m, world, random);
  }
}

}  // namespace

std::map<std::string, WorldBuilder> indoorBuilders() {
  return {{"doors", doors}, {"gates", gates}, {"painted_hall", paintedHall}, {"pillars", pillars}, {"rooms", rooms}};
}

}  // namespace flight_corridor::sim
