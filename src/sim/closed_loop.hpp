#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"
#include "sim/imu.hpp"
#include "sim/lidar.hpp"
#include "sim/policy.hpp"
#include "sim/quadrotor.hpp"
#include "sim/worlds.hpp"

namespace flight_corridor::sim {

struct ClosedLoopOptions {
  double rate_hz = 10.0;        ///< Of the stereo pairs.
  double image_scale = 0.5;     ///< 1 = 640x480.
  double baseline_error = 0.0;  ///< (true - announced) / announced [-].
  LidarFault lidar_fault;       ///< Times since the start.
  double processing_s = 0.05;   ///< From a pair's stamp to the command that it leads to.
  double patience_s = 60.0;     ///< Then the flight is given up.
  QuadrotorLimits quadrotor;
  SpeedConfig speed;                          ///< Of the policy; its delay is the quadrotor's latency.
  Eigen::Vector3d airframe_m{0.5, 0.5, 0.2};  ///< The body that must not touch anything: smaller than the corridor.
};

/// All that the UAV knows when a stereo pair has come.
struct Observation {
  StereoFrame pair;
  std::vector<RangeReading> ranges;  ///< Since the pair before.
  std::vector<ImuReading> imu;       ///< Since the pair before.
  OwnState own;                      ///< At the pair's stamp; the attitude is noisy.
  Eigen::Vector3d goal_W;
};

/// A rule that judges pairs, one after the other.
using Rule = std::function<Way(const Observation&)>;

enum class Ending : std::uint8_t { Goal, Collision, GivenUp };

/// Whose fault a collision is, by passive motion safety (Bouraine, Fraichard and Salhi 2012).
enum class Fault : std::uint8_t {
  None,     ///< No collision.
  Own,      ///< It hit what stands; or it moved, and had seen what it hit in time to stand, up to two seconds before.
  AtRest,   ///< It stood: it was hit by what moves.
  Outside,  ///< What it hit moves, and came from outside its view while it could not stand yet.
};
/// "", "own", "at_rest" or "outside".
const char* toString(Fault fault);

/// "goal", "collision" or "given_up".
const char* toString(Ending ending);

/// How a flight went.
struct Flown {
  Ending ending = Ending::GivenUp;
  double time_s = 0.0, distance_m = 0.0, top_speed_mps = 0.0;
  double waited_s = 0.0;         ///< Slower than 0.2 m/s.
  int stops = 0;                 ///< From above 0.5 to below 0.1 m/s.
  double nearest_m = kInfinity;  ///< Of the airframe to anything, at last 0 in a collision.
  std::optional<Primitive> hit;  ///< The primitive that was hit, at its place then.
  double hit_speed_mps = kNaN;   ///< Of the UAV.
  Fault fault = Fault::None;
  double out_of_view_s = kNaN;  ///< How long before the collision the place that was hit was last in the left camera's
                                ///< view, hidden or not.
};

/// Flies a world by a rule.
class ClosedLoop {
 public:
  ClosedLoop(World world, const ClosedLoopOptions& options, std::uint64_t seed);

  const StereoCalibration& calibration() const { return world_.scene.rig.calibration; }
  Eigen::Isometry3d T_B_C() const { return world_.scene.rig.T_B_C; }
  Eigen::Isometry3d T_C_L() const { return T_B_C().inverse() * world_.scene.rig.T_B_L; }
  const World& world() const { return world_; }

  /// @param watch called after each decision, for those who draw.
  Flown fly(const Rule& rule, const std::function<void(const Observation&, const Way&)>& watch = {});

 private:
  StereoFrame takePair(std::size_t index) const;
  void flyUntil(double time_s, Observation& next);
  void feel(Observation& next);
  void checkAirframe();
  void noteCollision(const Primitive& hit);

  World world_;
  ClosedLoopOptions options_;
  std::uint64_t seed_;
  Quadrotor quadrotor_;
  Lidar lidar_;
  Imu imu_;
  Flown flown_;
  struct Pair {
    double time_s;
    Eigen::Isometry3d T_W_B;
    double speed_mps;
  };
  bool isInView(const Pair& pair, const Eigen::Vector3d& place_W) const;

  std::vector<Pair> pairs_;  // so far
  bool is_moving_ = false;
};

}  // namespace flight_corridor::sim
