#include "sim/closed_loop.hpp"

#include <algorithm>

#include "sim/render.hpp"
#include "sim/shutter.hpp"
#include "sim/truth.hpp"

namespace flight_corridor::sim {
namespace {

constexpr double kTick_s = 0.02;    // of LiDAR, imu, and looks for collisions
constexpr double kArrived_m = 1.5;  // from the goal
constexpr double kWatched_m = 1.5;  // how far nearest_m looks
constexpr double kStanding_mps = 0.2;
constexpr double kRemembered_s = 2.0;  // what left the view so long ago may be where nobody knows

World withRig(World world, const ClosedLoopOptions& options) {
  scaleImages(world.scene.rig, options.image_scale);
  world.scene.rig.baseline_error = options.baseline_error;
  return world;
}

}  // namespace

const char* toString(Ending ending) {
  switch (ending) {
    case Ending::Goal:
      return "goal";
    case Ending::Collision:
      return "collision";
    case Ending::GivenUp:
      return "given_up";
  }
  return "";
}

const char* toString(Fault fault) {
  switch (fault) {
    case Fault::None:
      break;
    case Fault::Own:
      return "own";
    case Fault::AtRest:
      return "at_rest";
    case Fault::Outside:
      return "outside";
  }
  return "";
}

ClosedLoop::ClosedLoop(World world, const ClosedLoopOptions& options, std::uint64_t seed)
    : world_(withRig(std::move(world), options)),
      options_(options),
      seed_(seed),
      quadrotor_(options.quadrotor, world_.scene.flight.start_W, 0.0),
      lidar_(world_.scene.lidar, options.lidar_fault, seed),
      imu_(seed) {}

Flown ClosedLoop::fly(const Rule& rule, const std::function<void(const Observation&, const Way&)>& watch) {
  options_.speed.delay_s = options_.quadrotor.latency_s;
  Policy policy(options_.speed, options_.processing_s + 1.0 / options_.rate_hz);
  Observation observation;
  observation.goal_W = world_.goal_W;
  for (std::size_t i = 0; flown_.ending == Ending::GivenUp; ++i) {
    const double stamp_s = static_cast<double>(i) / options_.rate_hz;
    flyUntil(stamp_s, observation);
    if (flown_.ending != Ending::GivenUp || stamp_s > options_.patience_s) break;
    observation.pair = takePair(i);
    pairs_.push_back({quadrotor_.time_s(), quadrotor_.T_W_B(), quadrotor_.velocity_W_mps().norm()});
    observation.own = {quadrotor_.T_W_B(), quadrotor_.velocity_W_mps()};
    if (!observation.imu.empty()) observation.own.T_W_B.linear() = observation.imu.back().R_W_B.toRotationMatrix();
    const Way way = rule(observation);
    if (watch) watch(observation, way);
    const VelocityCommand command = policy.decide(observation.own, way, world_.goal_W);
    observation.ranges.clear();
    observation.imu.clear();
    flyUntil(stamp_s + options_.processing_s, observation);
    quadrotor_.command(command);
  }
  return flown_;
}

StereoFrame ClosedLoop::takePair(std::size_t index) const {
  const Scene& scene = world_.scene;
  const std::vector<Primitive> now = visibleAt(scene.world, quadrotor_.time_s());
  const auto image = [&](CameraOfRig camera_of_rig, const ImageSensor& sensor, Stream stream) {
    return expose(render(now, camera_of_rig(scene.rig, quadrotor_.T_W_B()), scene.light).radiance, sensor,
                  streamSeed(seed_, stream, index));
  };
  return {kFirstStamp_s + quadrotor_.time_s(), image(leftCamera, scene.rig.left, Stream::LeftImage),
          image(rightCamera, scene.rig.right, Stream::RightImage)};
}

void ClosedLoop::flyUntil(double time_s, Observation& next) {
  while (quadrotor_.time_s() < time_s - 1e-9 && flown_.ending == Ending::GivenUp) {
    const Eigen::Vector3d before_W = quadrotor_.T_W_B().translation();
    const double before_s = quadrotor_.time_s();
    quadrotor_.flyUntil(std::min(before_s + kTick_s, time_s));
    const double speed_mps = quadrotor_.velocity_W_mps().norm();
    flown_.time_s = quadrotor_.time_s();
    flown_.distance_m += (quadrotor_.T_W_B().translation() - before_W).norm();
    flown_.top_speed_mps = std::max(flown_.top_speed_mps, speed_mps);
    if (speed_mps < kStanding_mps) flown_.waited_s += quadrotor_.time_s() - before_s;
    if (is_moving_ && speed_mps < 0.1) ++flown_.stops;
    is_moving_ = is_moving_ ? speed_mps >= 0.1 : speed_mps > 0.5;
    feel(next);
    checkAirframe();
    const Eigen::Vector3d left_W = world_.goal_W - quadrotor_.T_W_B().translation();
    if (flown_.ending == Ending::GivenUp && left_W.head<2>().norm() < kArrived_m) flown_.ending = Ending::Goal;
  }
}

/// Readings of LiDAR and imu.
void ClosedLoop::feel(Observation& next) {
  const double time_s = quadrotor_.time_s(), stamp_s = kFirstStamp_s + time_s;
  const Eigen::Isometry3d T_W_B = quadrotor_.T_W_B();
  const std::vector<Primitive> now = visibleAt(world_.scene.world, time_s);
  const double range_m = castBeam(now, T_W_B * world_.scene.rig.T_B_L, world_.scene.lidar.field_of_view_rad);
  if (auto reading = lidar_.read(range_m, time_s)) {
    reading->stamp_s = stamp_s;
    next.ranges.push_back(*reading);
  }
  const Eigen::Vector3d turning_B(0.0, 0.0, quadrotor_.yawRate());
  next.imu.push_back(imu_.measure(stamp_s, T_W_B.linear(), quadrotor_.acceleration_W_mps2(), turning_B));
}

void ClosedLoop::checkAirframe() {
  const Eigen::Isometry3d T_W_F = quadrotor_.T_W_B() * Eigen::Translation3d(-options_.airframe_m.x() / 2.0, 0.0, 0.0);
  const std::vector<Primitive> now = visibleAt(world_.scene.world, quadrotor_.time_s());
  const double around_m = options_.airframe_m.norm() / 2.0 + std::min(kWatched_m, flown_.nearest_m);
  for (const Primitive& near : primitivesNear(now, quadrotor_.T_W_B().translation(), around_m)) {
    flown_.nearest_m = std::min(flown_.nearest_m, gapBetween(T_W_F, options_.airframe_m, near));
    if (flown_.nearest_m >= 1e-3) continue;
    noteCollision(near);
    return;
  }
}

void ClosedLoop::noteCollision(const Primitive& hit) {
  flown_.nearest_m = 0.0;
  flown_.ending = Ending::Collision;
  flown_.hit = hit;
  flown_.hit_speed_mps = quadrotor_.velocity_W_mps().norm();
  const Eigen::Vector3d away_O = hit.T_W_O.inverse() * quadrotor_.T_W_B().translation();
  const Eigen::Vector3d place_W = hit.T_W_O * away_O.cwiseMin(hit.half_m).cwiseMax(-hit.half_m);
  const auto placeAt = [&](double time_s) { return place_W - (flown_.time_s - time_s) * hit.velocity_W; };
  flown_.out_of_view_s = kInfinity;
  flown_.fault = hit.velocity_W.isZero()                ? Fault::Own
                 : flown_.hit_speed_mps < kStanding_mps ? Fault::AtRest
                                                        : Fault::Outside;
  for (const Pair& pair : pairs_) {
    if (!isInView(pair, placeAt(pair.time_s))) continue;
    const double since_s = flown_.time_s - pair.time_s;
    flown_.out_of_view_s = since_s;
    const double stands_s = timeToStand(pair.speed_mps, options_.processing_s + 1.0 / options_.rate_hz, options_.speed);
    const bool is_in_time = stands_s <= since_s && since_s <= stands_s + kRemembered_s;
    if (is_in_time && flown_.fault == Fault::Outside) flown_.fault = Fault::Own;
  }
}

/// Of the left camera, hidden or not.
bool ClosedLoop::isInView(const Pair& pair, const Eigen::Vector3d& place_W) const {
  const Camera camera = leftCamera(world_.scene.rig, pair.T_W_B);
  const Eigen::Vector3d place_C = camera.T_W_C.inverse() * place_W;
  const double u_px = camera.fx_px * place_C.x() / place_C.z() + camera.cx_px;
  const double v_px = camera.fy_px * place_C.y() / place_C.z() + camera.cy_px;
  return place_C.z() > 0.0 && 0.0 <= u_px && u_px < camera.size_px.width && 0.0 <= v_px && v_px < camera.size_px.height;
}

}  // namespace flight_corridor::sim
