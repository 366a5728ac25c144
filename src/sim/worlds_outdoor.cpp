#include <cmath>

#include "sim/scene_parts.hpp"
#include "sim/world_builders.hpp"

namespace flight_corridor::sim {
namespace {

constexpr double kRoom_m = 2.0;  // kept free about start and goal

Eigen::Vector2d anyPlace(const World& world, Random& random) {
  const double x_m = random.uniform(0.0, world.goal_W.x() + 1.0);
  const double y_m = random.uniform(world.ground_W.min().y(), world.ground_W.max().y());
  return {x_m, y_m};
}

bool isAwayFromTheEnds(const World& world, const Eigen::Vector2d& p_W, double reach_m) {
  const auto distance = [&](const Eigen::Vector3d& end_W) { return (end_W.head<2>() - p_W).norm(); };
  return std::min(distance(world.scene.flight.start_W), distance(world.goal_W)) > kRoom_m + reach_m;
}

/// Ground, and hills or houses all around the middle of the way.
void addOutdoors(World& world, Random& random) {
  addGround(1.5, world.scene, random);
  const std::size_t first = world.scene.world.size();
  addSurroundings(world.scene, random);
  for (std::size_t i = first; i < world.scene.world.size(); ++i) {
    world.scene.world[i].T_W_O.pretranslate(Eigen::Vector3d(world.goal_W.x() / 2.0, 0.0, 0.0));
  }
}

void addTrunks(int count, World& world, Random& random) {
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d p_W = anyPlace(world, random);
    const double radius_m = random.uniform(0.07, 0.25);
    const Eigen::Vector3d foot_W(p_W.x(), p_W.y(), 0.0);
    const Eigen::Vector3d lean{random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), 8.0};
    const Primitive trunk = makeCylinder(foot_W, foot_W + lean, radius_m, bark(random));
    if (isAwayFromTheEnds(world, p_W, radius_m)) world.scene.world.push_back(trunk);
  }
}

/// Trunks 4 to 5 m apart.
void thinForest(World& world, Random& random) {
  addOutdoors(world, random);
  addTrunks(26, world, random);
}

/// Trunks 2 to 3 m apart, boughs at the height of flight and bushes.
void thickForest(World& world, Random& random) {
  addOutdoors(world, random);
  addTrunks(50, world, random);
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector2d p_W = anyPlace(world, random);
    const double bearing_rad = random.uniform(0.0, 2.0 * M_PI);
    const double length_m = random.uniform(0.8, 1.6);
    const double z_m = random.uniform(1.0, 2.2);
    const double rise_m = random.uniform(0.2, 0.8);
    const double radius_m = random.uniform(0.02, 0.04);
    const Eigen::Vector3d trunk_W(p_W.x(), p_W.y(), z_m);
    const Eigen::Vector3d bough(length_m * std::cos(bearing_rad), length_m * std::sin(bearing_rad), rise_m);
    if (!isAwayFromTheEnds(world, p_W, length_m)) continue;
    const Material wood = bark(random);
    world.scene.world.push_back(uprightPole(p_W.x(), p_W.y(), random.uniform(0.08, 0.15), 7.0, wood));
    world.scene.world.push_back(makeCylinder(trunk_W, trunk_W + bough, radius_m, wood));
  }
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector2d p_W = anyPlace(world, random);
    const double radius_m = random.uniform(0.3, 0.9);
    if (!isAwayFromTheEnds(world, p_W, radius_m)) continue;
    world.scene.world.push_back(
        makeFoliage({p_W.x(), p_W.y(), 0.4 * radius_m}, radius_m, textured(random, 0.45, 0.3, 0.05)));
  }
}

/// Saplings 2 to 5 cm thick that lean, some with a leaf of 4 to 9 cm, boughs of 3 to 8 cm across the way.
void understorey(World& world, Random& random) {
  addOutdoors(world, random);
  addTrunks(12, world, random);
  for (int i = 0; i < 70; ++i) {
    const Eigen::Vector2d p_W = anyPlace(world, random);
    const double radius_m = random.uniform(0.01, 0.025);
    const Eigen::Vector3d foot_W(p_W.x(), p_W.y(), 0.0);
    const Eigen::Vector3d lean{random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), random.uniform(2.0, 4.0)};
    const double leaf_m = random.uniform(0.04, 0.09);
    const Material wood = bark(random);
    const bool has_leaf = random.chance(0.5);
    if (!isAwayFromTheEnds(world, p_W, 0.6)) continue;
    world.scene.world.push_back(makeCylinder(foot_W, foot_W + lean, radius_m, wood));
    if (!has_leaf) continue;
    const Material green = textured(random, 0.45, 0.3, 0.05);
    world.scene.world.push_back(turned(makeBox(foot_W + 0.4 * lean, {0.003, leaf_m, leaf_m}, green), p_W.x()));
  }
  for (int i = 0; i < 10; ++i) {
    const Eigen::Vector2d p_W = anyPlace(world, random);
    const double bearing_rad = random.uniform(0.0, 2.0 * M_PI);
    const Eigen::Vector3d across(1.5 * std::cos(bearing_rad), 1.5 * std::sin(bearing_rad), random.uniform(-0.5, 0.5));
    const Eigen::Vector3d middle_W(p_W.x(), p_W.y(), random.uniform(1.2, 1.8));
    const double radius_m = random.uniform(0.015, 0.04);
    const Material wood = bark(random);
    if (!isAwayFromTheEnds(world, p_W, 1.5)) continue;
    world.scene.world.push_back(makeCylinder(middle_W - across, middle_W + across, radius_m, wood));
  }
}

/// Hilltops, some to be flown over, others to be flown round, and a few trees.
void hills(World& world, Random& random) {
  addOutdoors(world, random);
  for (int i = 0; i < 9; ++i) {
    const Eigen::Vector2d p_W = anyPlace(world, random);
    const double radius_m = random.uniform(4.0, 14.0);
    const double top_m = random.uniform(0.6, 2.6);
    const double reach_m = std::sqrt(radius_m * radius_m - (radius_m - top_m) * (radius_m - top_m));
    const Material grass = textured(random, 0.45, 0.3, 1.0);
    if (!isAwayFromTheEnds(world, p_W, reach_m)) continue;
    world.scene.world.push_back(makeSphere({p_W.x(), p_W.y(), top_m - radius_m}, radius_m, grass));
  }
  addTrunks(8, world, random);
}

/// A cable from a post to the ground or to another post.
void addCable(const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W, World& world, Random& random) {
  world.scene.world.push_back(
      makeCylinder(from_W, to_W, random.uniform(0.0125, 0.02), textured(random, 0.15, 0.25, 0.16)));
}

/// Between two rows of houses: posts, their stays of cable 25 to 40 mm thick, cables overhead, cars and signs.
void street(World& world, Random& random) {
  addGround(0.8, world.scene, random);
  const double half_width_m = random.uniform(4.0, 5.5);
  for (const double side : {-1.0, 1.0}) {
    for (double x_m = -6.0; x_m < 40.0; x_m += 9.0) {
      const double front_m = half_width_m + random.uniform(0.0, 0.6);
      world.scene.world.push_back(
          makeBox({x_m, side * (front_m + 3.0), 4.0}, {9.0, 6.0, 8.0}, textured(random, 0.45, 0.3, 0.6)));
    }
  }
  world.scene.world.push_back(wallAcross(36.0, -12.0, 12.0, 9.0, masonry(random)));
  world.scene.world.push_back(wallAcross(-12.0, -12.0, 12.0, 9.0, masonry(random)));
  for (double x_m = 4.0; x_m < world.goal_W.x() - 2.0; x_m += random.uniform(4.0, 6.0)) {
    const double side = random.sign();
    const double y_m = side * random.uniform(1.0, half_width_m - 0.6);
    const double top_m = random.uniform(4.0, 6.0);
    const double stay_x_m = random.uniform(-1.5, 1.5);
    const double stay_y_m = random.uniform(0.8, 2.5);
    world.scene.world.push_back(uprightPole(x_m, y_m, random.uniform(0.06, 0.12), top_m, bark(random)));
    addCable({x_m, y_m, top_m - 0.5}, {x_m + stay_x_m, y_m - side * stay_y_m, 0.0}, world, random);
    addCable({x_m, y_m, top_m - 0.2}, {x_m + 0.4, -side * half_width_m, top_m - 0.4}, world, random);
  }
  for (int i = 0; i < 5; ++i) {
    const double x_m = random.uniform(4.0, world.goal_W.x() - 4.0);
    const double y_m = random.eitherSign(1.0, half_width_m - 1.0);
    const double height_m = random.chance(0.6) ? 1.5 : 2.5;
    world.scene.world.push_back(makeBox({x_m, y_m, height_m / 2.0}, {random.uniform(2.5, 4.5), 1.8, height_m},
                                        textured(random, 0.4, 0.3, 0.4)));
  }
}

/// Between two rows of houses, poles of 9 to 13 cm of the houses' own plain grey.
void alley(World& world, Random& random) {
  addGround(0.8, world.scene, random);
  const Material grey = plain(random.uniform(0.35, 0.55));
  const double half_width_m = random.uniform(3.5, 4.5);
  for (const double side : {-1.0, 1.0}) {
    for (double x_m = -6.0; x_m < 40.0; x_m += 9.0) {
      const double front_m = half_width_m + random.uniform(0.0, 0.6);
      const Material front = random.chance(0.5) ? grey : textured(random, 0.45, 0.3, 0.6);
      world.scene.world.push_back(makeBox({x_m, side * (front_m + 3.0), 4.0}, {9.0, 6.0, 8.0}, front));
    }
  }
  world.scene.world.push_back(wallAcross(36.0, -12.0, 12.0, 9.0, grey));
  world.scene.world.push_back(wallAcross(-12.0, -12.0, 12.0, 9.0, masonry(random)));
  for (double x_m = 3.5; x_m < world.goal_W.x() - 2.0; x_m += random.uniform(1.5, 3.0)) {
    const double y_m = random.uniform(-half_width_m + 0.4, half_width_m - 0.4);
    world.scene.world.push_back(uprightPole(x_m, y_m, random.uniform(0.045, 0.065), random.uniform(3.0, 6.0), grey));
  }
}

/// Walks across the way for ever, at it at a moment.
void addPerson(World& world, Random& random) {
  const double x_m = random.uniform(4.0, world.goal_W.x() - 3.0);
  const double crosses_s = random.uniform(0.0, 40.0);
  const double speed_m_s = random.eitherSign(0.5, 1.2);
  const double bearing_rad = M_PI / 2.0 + random.uniform(-0.5, 0.5);
  const Eigen::Vector3d velocity_W = speed_m_s * Eigen::Vector3d(std::cos(bearing_rad), std::sin(bearing_rad), 0.0);
  const Eigen::Vector3d start_W = Eigen::Vector3d(x_m, 0.0, 0.0) - crosses_s * velocity_W;
  Primitive body = makeCylinder(start_W, start_W + Eigen::Vector3d(0, 0, 1.5), 0.22, textured(random, 0.35, 0.35, 0.2));
  Primitive head = makeSphere(start_W + Eigen::Vector3d(0, 0, 1.65), 0.13, textured(random, 0.55, 0.3, 0.1));
  body.velocity_W = head.velocity_W = velocity_W;
  world.scene.world.insert(world.scene.world.end(), {body, head});
}

/// A square with a few trees that people cross.
void people(World& world, Random& random) {
  addOutdoors(world, random);
  addTrunks(10, world, random);
  for (int i = 0; i < 14; ++i) addPerson(world, random);
}

}  // namespace

std::map<std::string, WorldBuilder> outdoorBuilders() {
  return {{"alley", alley},
          {"forest_thick", thickForest},
          {"forest_thin", thinForest},
          {"hills", hills},
          {"people", people},
          {"street", street},
          {"understorey", understorey}};
}

}  // namespace flight_corridor::sim
