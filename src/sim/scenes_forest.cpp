#include <cmath>

#include "sim/scene_builders.hpp"
#include "sim/scene_parts.hpp"

namespace flight_corridor::sim {
namespace {

// The way: straight on, round an oak to the left, through a gate that is slid open, round another oak back to the
// right, up to a third one.
constexpr double kSpeed_m_s = 1.5;
constexpr double kLeftLane_m = 1.4;
constexpr double kFirstOak_x_m = 8.0, kGate_x_m = 15.0, kSecondOak_x_m = 22.5, kLastOak_x_m = 29.0;
constexpr double kHalfGate_m = 1.15;
constexpr double kTreesUntil_x_m = 42.0;

Material grass(Random& random) { return textured(random, 0.60, 0.3, 0.03); }
Material leaves(Random& random) { return textured(random, 0.55, 0.3, 0.03); }
Material planks(Random& random) {
  Material wood = textured(random, 0.5, 0.25, 0.06);
  wood.stretch = 12.0f;
  return wood;
}

Material oakBark(Random& random) {
  Material oak = textured(random, 0.32, 0.55, 0.12);
  oak.stretch = 4.0f;
  return oak;
}

/// When the camera is at x, in mid-flight.
double timeAt(double x_m, const Scene& scene) { return (x_m - kAhead_m) / kSpeed_m_s + scene.flight.ramp_s / 2.0; }

Eigen::Vector3d anyDirection(Random& random) {
  const double bearing_rad = random.uniform(0.0, 2.0 * M_PI);
  const double up = random.uniform(-1.0, 1.0);
  const double level = std::sqrt(1.0 - up * up);
  return {level * std::cos(bearing_rad), level * std::sin(bearing_rad), up};
}

Primitive turnedFoliage(const Eigen::Vector3d& centre_W, double radius_m, const Material& material, Random& random) {
  Primitive foliage = makeFoliage(centre_W, radius_m, material);
  const double angle_rad = random.uniform(0.0, 2.0 * M_PI);
  foliage.T_W_O.rotate(Eigen::AngleAxisd(angle_rad, anyDirection(random)));
  return foliage;
}

/// A branch that rises outwards, with leaves along its outer half and at its end.
void addBranch(const Eigen::Vector3d& from_W, double length_m, const Material& bark, Scene& scene, Random& random) {
  const double bearing_rad = random.uniform(0.0, 2.0 * M_PI);
  const double rise = random.uniform(0.25, 0.8);
  const Eigen::Vector3d outwards = Eigen::Vector3d(std::cos(bearing_rad), std::sin(bearing_rad), rise).normalized();
  const Eigen::Vector3d elbow_W = from_W + 0.5 * length_m * outwards;
  const Eigen::Vector3d end_W = elbow_W + 0.5 * length_m * (outwards + 0.5 * Eigen::Vector3d::UnitZ()).normalized();
  const double radius_m = 0.022 * length_m;
  scene.world.push_back(makeCylinder(from_W, elbow_W, radius_m, bark));
  scene.world.push_back(makeCylinder(elbow_W, end_W, 0.7 * radius_m, bark));
  for (const Eigen::Vector3d& bough_W : {elbow_W, end_W}) {
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector3d off_m = 0.25 * length_m * anyDirection(random);
      const double leafy_m = random.uniform(0.15, 0.27) * length_m;
      scene.world.push_back(turnedFoliage(bough_W + off_m, leafy_m, leaves(random), random));
    }
  }
}

/// A trunk that leans and thins, and branches from a height on that a UAV passes below.
void addTree(double x_m, double y_m, double radius_m, Scene& scene, Random& random) {
  constexpr int kPieces = 8;
  constexpr double kPiece_m = 1.15, kThinner = 0.92, kLowestBranch_m = 3.3;
  const Material bark = oakBark(random);
  Eigen::Vector3d foot_W(x_m, y_m, 0.0);
  for (int piece = 0; piece < kPieces; ++piece) {
    const double lean_x = random.uniform(-0.08, 0.08);
    const double lean_y = random.uniform(-0.07, 0.07);
    const Eigen::Vector3d along = kPiece_m * Eigen::Vector3d(piece == 0 ? 0.0 : lean_x, piece == 0 ? 0.0 : lean_y, 1.0);
    scene.world.push_back(makeCylinder(foot_W, foot_W + along, radius_m, bark));
    for (int branch = 0; branch < 2; ++branch) {
      const Eigen::Vector3d fork_W = foot_W + random.uniform(0.0, 1.0) * along;
      if (fork_W.z() > kLowestBranch_m) addBranch(fork_W, random.uniform(1.2, 2.6), bark, scene, random);
    }
    foot_W += along;
    radius_m *= kThinner;
  }
}

/// Whether something that reaches so far is out of the UAV's way, wherever that runs.
bool isBesideTheWay(double y_m, double reach_m, const Scene& scene) {
  constexpr double kFree_m = 1.25;
  return y_m + reach_m < middle(scene) - kFree_m || y_m - reach_m > middle(scene) + kLeftLane_m + kFree_m;
}

void addTrees(Scene& scene, Random& random) {
  constexpr int kTrees = 30;
  constexpr double kFarthest_y_m = 14.0;
  for (int i = 0; i < kTrees; ++i) {
    const double x_m = 2.0 + (kTreesUntil_x_m - 2.0) * (i + random.uniform(0.0, 1.0)) / kTrees;
    const double y_m = random.uniform(-kFarthest_y_m, kFarthest_y_m);
    const double radius_m = random.uniform(0.09, 0.24);
    if (x_m > kLastOak_x_m || isBesideTheWay(y_m, radius_m, scene)) addTree(x_m, y_m, radius_m, scene, random);
  }
}

/// Bushes, tufts and stones at the sides; all of it below the UAV where it is in its way.
void addUndergrowth(Scene& scene, Random& random) {
  for (int i = 0; i < 600; ++i) {
    const double x_m = random.uniform(1.0, kTreesUntil_x_m);
    const double y_m = random.uniform(-9.0, 9.0);
    const double radius_m = random.uniform(0.08, 0.26);
    if (isBesideTheWay(y_m, -0.6, scene))
      scene.world.push_back(turnedFoliage({x_m, y_m, 0.0}, radius_m, grass(random), random));
  }
  for (int i = 0; i < 60; ++i) {
    const double x_m = random.uniform(1.0, kTreesUntil_x_m);
    const double y_m = random.uniform(-11.0, 11.0);
    const double radius_m = random.uniform(0.3, 0.7);
    if (!isBesideTheWay(y_m, radius_m + 0.3, scene)) continue;
    scene.world.push_back(turnedFoliage({x_m, y_m, 0.5 * radius_m}, radius_m, leaves(random), random));
    scene.world.push_back(turnedFoliage({x_m + 0.5 * radius_m, y_m, 0.2}, 0.7 * radius_m, leaves(random), random));
  }
  for (int i = 0; i < 40; ++i) {
    const double x_m = random.uniform(2.0, kTreesUntil_x_m);
    const double y_m = random.uniform(-6.0, 6.0);
    const double radius_m = random.uniform(0.08, 0.3);
    scene.world.push_back(makeSphere({x_m, y_m, -0.4 * radius_m}, radius_m, textured(random, 0.35, 0.3, 0.15)));
  }
}

/// What closes the view: a dark wood in the haze, taller than all before it.
void addFarWood(Scene& scene, Random& random) {
  constexpr double kDistance_m = 48.0;
  for (int i = 0; i < 110; ++i) {
    const double bearing_rad = 2.0 * M_PI * (i + random.uniform(-0.25, 0.25)) / 110;
    const double distance_m = kDistance_m + random.uniform(-3.0, 3.0);
    const double height_m = random.uniform(5.0, 11.0);
    const double x_m = 15.0 + distance_m * std::cos(bearing_rad), y_m = distance_m * std::sin(bearing_rad);
    const double radius_m = random.uniform(2.0, 2.6);
    scene.world.push_back(uprightPole(x_m, y_m, radius_m, 0.8 * height_m, textured(random, 0.2, 0.4, 2.0)));
    for (int crown = 0; crown < 2; ++crown) {
      const double z_m = height_m * random.uniform(0.4, 1.0);
      const double off_m = random.uniform(-2.0, 2.0);
      scene.world.push_back(turnedFoliage({x_m, y_m + off_m, z_m}, 2.6, textured(random, 0.3, 0.4, 0.9), random));
    }
  }
}

/// A primitive that stands until a moment, then moves for a while, then stands again.
void addSliding(Primitive primitive, double from_s, double until_s, const Eigen::Vector3d& velocity_W, Scene& scene) {
  Primitive before = primitive, moving = primitive, after = primitive;
  before.visible_until_s = moving.visible_from_s = from_s;
  moving.visible_until_s = after.visible_from_s = until_s;
  moving.velocity_W = velocity_W;
  moving.T_W_O.translation() -= from_s * velocity_W;
  after.T_W_O.translation() += (until_s - from_s) * velocity_W;
  for (const Primitive& phase : {before, moving, after}) scene.world.push_back(phase);
}

/// Two posts with a beam across, fences at both sides, and a door of planks that slides open behind the left fence.
void addGate(Scene& scene, Random& random) {
  constexpr double kPost_m = 0.09, kTop_m = 2.6, kFence_m = 1.0;
  const double y_m = middle(scene) + kLeftLane_m;
  const Material wood = planks(random);
  const double opening_m = kHalfGate_m + kPost_m;
  for (const double side : {-1.0, 1.0}) {
    scene.world.push_back(uprightPole(kGate_x_m, y_m + side * opening_m, kPost_m, kTop_m + 0.2, wood));
    for (int post = 1; post <= 5; ++post) {
      const double from_m = opening_m + 2.0 * (post - 1), to_m = from_m + 2.0;
      scene.world.push_back(uprightPole(kGate_x_m, y_m + side * to_m, 0.06, kFence_m + 0.1, planks(random)));
      for (const double rail_z_m : {0.4, 0.9}) {
        scene.world.push_back(makeCylinder({kGate_x_m, y_m + side * from_m, rail_z_m},
                                           {kGate_x_m, y_m + side * to_m, rail_z_m}, 0.045, planks(random)));
      }
    }
  }
  scene.world.push_back(
      makeCylinder({kGate_x_m, y_m - opening_m - 0.3, kTop_m}, {kGate_x_m, y_m + opening_m + 0.3, kTop_m}, 0.08, wood));
  constexpr int kPlanks = 12;
  constexpr double kPlank_m = 2.0 * kHalfGate_m / kPlanks, kSlide_m_s = 2.0;
  const double opens_s = timeAt(kGate_x_m - 2.4, scene);
  for (int i = 0; i < kPlanks; ++i) {
    const Eigen::Vector3d centre_W(kGate_x_m + 0.2, y_m - kHalfGate_m + (i + 0.5) * kPlank_m, 1.15);
    const Primitive plank =
        makeBox(centre_W, {0.05, kPlank_m - 0.008, 1.9 + random.uniform(-0.04, 0.04)}, planks(random));
    addSliding(plank, opens_s, opens_s + 2.0 * kHalfGate_m / kSlide_m_s, {0.0, kSlide_m_s, 0.0}, scene);
  }
}

void lightUp(Scene& scene) {
  scene.light.to_sun_W = Eigen::Vector3d(0.25, 0.75, 0.75).normalized();
  scene.light.ambient = 0.45f;
  scene.light.haze_m = 100.0;
  scene.light.has_clouds = true;
  std::vector<Primitive> standing;
  for (const Primitive& primitive : scene.world) {
    if (primitive.visible_from_s == -kInfinity && primitive.visible_until_s == kInfinity) standing.push_back(primitive);
  }
  const Eigen::AlignedBox3d wood_W(Eigen::Vector3d(-3.0, -14.0, 0.0),
                                   Eigen::Vector3d(kTreesUntil_x_m + 3.0, 14.0, 8.0));
  scene.light.shadows = std::make_shared<const Shadows>(standing, scene.light.to_sun_W, wood_W);
  scene.rig.left.gain = scene.rig.right.gain = 320.0;
}

/// Through a wood and past a gate: FREE, and BLOCKED by an oak, the gate until it opens, an oak, and the last oak.
void forestGate(Scene& scene, Random& random) {
  scene.world.clear();
  scene.world.push_back(makeBox({0, 0, -0.5}, {300, 300, 1}, textured(random, 0.42, 0.40, 0.5)));
  flyUntil(scene, kLastOak_x_m - 1.9, kSpeed_m_s);
  scene.flight.wobble_rad = {0.02, 0.01, 0.01};
  scene.flight.sidesteps = {{timeAt(kFirstOak_x_m - 2.7, scene), 1.6, kLeftLane_m},
                            {timeAt(kSecondOak_x_m - 2.7, scene), 1.6, -kLeftLane_m}};
  addTree(kFirstOak_x_m, middle(scene) - 0.1, 0.24, scene, random);
  addTree(kSecondOak_x_m, middle(scene) + kLeftLane_m + 0.1, 0.26, scene, random);
  addTree(kLastOak_x_m + 0.35, middle(scene), 0.35, scene, random);
  addTrees(scene, random);
  addUndergrowth(scene, random);
  addFarWood(scene, random);
  addGate(scene, random);
  lightUp(scene);
}

}  // namespace

std::vector<SceneBuilder> shownBuilders() { return {{"forest_gate", Visibility::Visible, forestGate}}; }

}  // namespace flight_corridor::sim
