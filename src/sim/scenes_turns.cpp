#include <cmath>

#include "sim/scene_builders.hpp"
#include "sim/scene_parts.hpp"

namespace flight_corridor::sim {
namespace {

constexpr double kDegree_rad = M_PI / 180.0;

/// Points at a bearing from where the flight starts, left positive.
Eigen::Vector3d atBearing(double bearing_rad, double distance_m) {
  return {distance_m * std::cos(bearing_rad), distance_m * std::sin(bearing_rad), 0.0};
}

/// Turns a primitive that stands ahead of the start to a bearing, about the vertical through the start.
Primitive turnedTo(double bearing_rad, Primitive primitive) {
  primitive.T_W_O.prerotate(Eigen::AngleAxisd(bearing_rad, Eigen::Vector3d::UnitZ()));
  return primitive;
}

/// Equal pickets on two rails, so placed that the beam passes between two of them.
void addPickets(double distance_m, double bearing_rad, Scene& scene, Random& random) {
  constexpr double kThick_m = 0.02, kHalf_m = 3.0, kTop_m = 2.2;
  const double width_m = random.uniform(0.05, 0.08);
  const double period_m = width_m + random.uniform(0.07, 0.12);
  const double beam_y_m = scene.rig.T_B_L.translation().y();
  const Material wood = textured(random, 0.5, 0.25, 0.16);
  for (double y_m = beam_y_m + 0.5 * period_m; y_m < kHalf_m; y_m += period_m) {
    for (const double across_m : {y_m, 2.0 * beam_y_m - y_m}) {
      scene.world.push_back(
          turnedTo(bearing_rad, makeBox({kAhead_m + distance_m + kThick_m / 2.0, across_m, kTop_m / 2.0},
                                        {kThick_m, width_m, kTop_m}, wood)));
    }
  }
  for (const double z_m : {0.4, kTop_m - 0.3}) {
    scene.world.push_back(turnedTo(
        bearing_rad, makeBox({kAhead_m + distance_m + 0.04, beam_y_m, z_m}, {0.04, 2.0 * kHalf_m, 0.08}, wood)));
  }
}

/// Hovers and turns: from where the way is free past trunks and a chequered wall, at up to 60 degrees/s and more, to a
/// fence 2.5 m away between whose pickets the beam passes; there it stays.
void turning(Scene& scene, Random& random) {
  const double side = random.sign();
  const double fence_rad = side * random.uniform(100.0, 130.0) * kDegree_rad;
  const double rate_rad_s = random.uniform(60.0, 75.0) * kDegree_rad;
  flySteadily(scene);
  scene.flight.speed_m_s = 0.0;
  scene.flight.turns = {turnAt(1.5, fence_rad, rate_rad_s)};
  scene.flight.duration_s = 1.5 + scene.flight.turns.front().duration_s + 2.0;
  for (const double share : {0.22, 0.34}) {
    const double distance_m = random.uniform(2.0, 3.5);
    const double radius_m = random.uniform(0.1, 0.25);
    const Eigen::Vector3d foot_W = atBearing(share * fence_rad, distance_m);
    scene.world.push_back(uprightPole(foot_W.x(), foot_W.y(), radius_m, 5.0, bark(random)));
  }
  Material chequered = textured(random, 0.5, 0.04, 0.3);
  chequered.checker_period_m = 0.4f;
  const double wall_m = random.uniform(4.5, 5.5);
  scene.world.push_back(
      turnedTo(0.6 * fence_rad, makeBox({kAhead_m + wall_m + 0.15, 0.0, 2.5}, {0.3, 5.0, 5.0}, chequered)));
  addPickets(2.5, fence_rad, scene, random);
  for (const double bearing_rad : {0.0, fence_rad}) {
    const double house_m = random.uniform(8.0, 10.0);
    scene.world.push_back(
        turnedTo(bearing_rad, makeBox({kAhead_m + house_m, 0.0, 5.0}, {0.3, 16.0, 10.0}, masonry(random))));
  }
}

/// Round trunks, to the left and to the right: turns at up to 60 degrees/s, banks as they demand, climbs and sinks, up
/// to the last trunk, which it flies at.
void weaving(Scene& scene, Random& random) {
  constexpr double kTurn_rad = 40.0 * kDegree_rad, kRate_rad_s = 60.0 * kDegree_rad;
  constexpr int kBends = 4;
  Flight& flight = scene.flight;
  flight.tilts = true;
  flight.wobble_rad = {0.02, 0.02, 0.01};
  flight.speed_m_s = random.uniform(1.5, 2.5);
  const double side = random.sign();
  double time_s = flight.ramp_s;
  for (int bend = 0; bend <= kBends; ++bend) {  // half a turn, whole turns to and fro, half a turn back
    const bool is_half = bend == 0 || bend == kBends;
    const double left_rad = (bend % 2 == 0 ? side : -side) * (is_half ? 1.0 : 2.0) * kTurn_rad;
    flight.turns.push_back(turnAt(time_s, left_rad, kRate_rad_s));
    time_s += flight.turns.back().duration_s;
  }
  flight.sidesteps = {{1.0, 2.0, 0.0, random.uniform(0.2, 0.5)}, {3.5, 2.0, 0.0, -random.uniform(0.2, 0.5)}};
  flight.duration_s = time_s + 1.0;
  const auto camera = [&](double at_s) { return leftCamera(scene.rig, flight.T_W_B(at_s)).T_W_C; };
  const auto addTrunk = [&](const Eigen::Vector3d& foot_W) {
    scene.world.push_back(uprightPole(foot_W.x(), foot_W.y(), random.uniform(0.1, 0.25), 6.0, bark(random)));
  };
  for (int bend = 1; bend < kBends; ++bend) {  // for each whole turn one that it avoids, and one that it rounds
    const Turn& turn = flight.turns[bend];
    const double inside = turn.left_rad > 0.0 ? 1.0 : -1.0;
    addTrunk(camera(turn.from_s) * Eigen::Vector3d(random.uniform(-0.3, 0.3), 0.0, 1.9 * flight.speed_m_s));
    addTrunk(flight.T_W_B(turn.from_s + turn.duration_s / 2.0) *
             Eigen::Vector3d(0.0, inside * random.uniform(1.2, 1.6), 0.0));
  }
  const Eigen::Vector3d last_W = camera(flight.duration_s) * Eigen::Vector3d(random.uniform(-0.3, 0.3), 0.0, 1.8);
  addTrunk(last_W);
  scene.world.push_back(wallAcross(last_W.x() + 6.0, -40.0, 40.0, 20.0, masonry(random)));
}

}  // namespace

std::vector<SceneBuilder> turnBuilders() {
  return {{"turning", Visibility::Visible, turning}, {"weaving", Visibility::Visible, weaving}};
}

}  // namespace flight_corridor::sim
