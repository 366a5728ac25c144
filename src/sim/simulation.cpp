#include "sim/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/lidar.hpp"
#include "sim/random.hpp"
#include "sim/render.hpp"
#include "sim/shutter.hpp"

namespace flight_corridor::sim {
namespace {

constexpr double kImuRate_hz = 200.0;
constexpr double kYaw_rad = 25.0 * M_PI / 180.0;  // to either side, when yawing to and fro
constexpr double kStraight_s = 0.3;               // before it, at least, and after it

const SimulationOptions& checked(const SimulationOptions& options) {
  std::string broken;
  const auto require = [&](bool holds, const char* rule) {
    if (!holds) broken += (broken.empty() ? "" : "; ") + std::string(rule);
  };
  require(1.0 <= options.rate_hz && options.rate_hz <= 1000.0, "rate_hz must be within [1, 1000]");
  require(options.duration_s >= 0.0, "duration_s must be at least 0");
  require(0.1 <= options.image_scale && options.image_scale <= 4.0, "image_scale must be within [0.1, 4]");
  require((options.corridor_m.array() > 0.2).all(), "each size in corridor_m must be above 0.2");
  const double baseline_error = options.baseline_error.value_or(0.0);
  require(-0.5 <= baseline_error && baseline_error <= 0.5, "baseline_error must be within [-0.5, 0.5]");
  const double offset_px = options.disparity_offset_px.value_or(0.0);
  require(-20.0 <= offset_px && offset_px <= 20.0, "disparity_offset_px must be within [-20, 20]");
  require(0.0 <= options.yaw_rate_rad_s && options.yaw_rate_rad_s <= 4.0, "yaw_rate_rad_s must be within [0, 4]");
  if (!broken.empty()) throw std::invalid_argument("simulation: " + broken);
  return options;
}

Scene sceneFor(const SimulationOptions& options) {
  Scene scene = makeScene(options.scene, options.seed);
  scaleImages(scene.rig, options.image_scale);
  scene.rig.baseline_error = options.baseline_error.value_or(scene.rig.baseline_error);
  scene.rig.disparity_offset_px = options.disparity_offset_px.value_or(scene.rig.disparity_offset_px);
  if (options.yaw_rate_rad_s > 0.0) {
    scene.flight.body_yaws =
        yawSweep(kStraight_s, scene.flight.duration_s - kStraight_s, kYaw_rad, options.yaw_rate_rad_s);
  }
  return scene;
}

/// Ascending times within [0, duration], a period apart; none at a rate of 0.
std::vector<double> ticks(double duration_s, double rate_hz) {
  std::vector<double> times_s;
  if (rate_hz == 0.0) return times_s;
  for (int i = 0; i / rate_hz <= duration_s; ++i) times_s.push_back(i / rate_hz);
  return times_s;
}

}  // namespace

Simulation::Simulation(const SimulationOptions& options)
    : options_(checked(options)),
      scene_(sceneFor(options)),
      lidar_fault_{lidarFaultFromName(options.lidar_fault), options.lidar_fault_from_s, options.lidar_fault_until_s},
      duration_s_(std::min(options.duration_s, scene_.flight.duration_s)),
      frame_times_s_(ticks(duration_s_, options.rate_hz)) {
  for (double& time_s : frame_times_s_) time_s += kFirstStamp_s;
}

Eigen::Isometry3d Simulation::T_W_B(double stamp_s) const { return scene_.flight.T_W_B(stamp_s - kFirstStamp_s); }

StereoFrame Simulation::frame(std::size_t index) const {
  const double stamp_s = frame_times_s_.at(index);
  const cv::Mat left = collectLight(scene_, stamp_s - kFirstStamp_s, leftCamera);
  const cv::Mat right = collectLight(scene_, stamp_s - kFirstStamp_s, rightCamera);
  return {stamp_s, expose(left, scene_.rig.left, streamSeed(options_.seed, Stream::LeftImage, index)),
          expose(right, scene_.rig.right, streamSeed(options_.seed, Stream::RightImage, index))};
}

std::vector<RangeReading> Simulation::ranges() const {
  std::vector<RangeReading> readings;
  Lidar lidar(scene_.lidar, lidar_fault_, options_.seed);
  for (const double time_s : ticks(duration_s_, scene_.lidar.rate_hz)) {
    const double stamp_s = kFirstStamp_s + time_s;
    const double range_m = castBeam(worldAt(stamp_s), T_W_B(stamp_s) * T_B_L(), scene_.lidar.field_of_view_rad);
    auto reading = lidar.read(range_m, time_s);
    if (!reading) continue;
    reading->stamp_s = stamp_s;
    readings.push_back(*reading);
  }
  return readings;
}

/// The acceleration by the central second difference of the pose, so that summing it twice gives the flight again; the
/// angular velocity by the central first difference.
std::vector<ImuReading> Simulation::imuReadings() const {
  std::vector<ImuReading> readings;
  Imu imu(options_.seed);
  const double step_s = 1.0 / kImuRate_hz;
  for (const double time_s : ticks(duration_s_ - 2.0 * step_s, kImuRate_hz)) {
    const double stamp_s = kFirstStamp_s + time_s + step_s;
    const Eigen::Isometry3d before = T_W_B(stamp_s - step_s), now = T_W_B(stamp_s), after = T_W_B(stamp_s + step_s);
    const Eigen::Vector3d acceleration_W =
        (before.translation() - 2.0 * now.translation() + after.translation()) / (step_s * step_s);
    const Eigen::AngleAxisd turned_B(before.linear().transpose() * after.linear());
    readings.push_back(
        imu.measure(stamp_s, now.linear(), acceleration_W, turned_B.angle() / (2.0 * step_s) * turned_B.axis()));
  }
  return readings;
}

CorridorTruth Simulation::truth(std::size_t index) const {
  const double stamp_s = frame_times_s_.at(index);
  return corridorTruth(worldAt(stamp_s), T_W_B(stamp_s) * T_B_C(), options_.corridor_m);
}

cv::Mat Simulation::depth(std::size_t index) const {
  const double stamp_s = frame_times_s_.at(index);
  return render(worldAt(stamp_s), leftCamera(scene_.rig, T_W_B(stamp_s))).depth_m;
}

std::vector<Primitive> Simulation::worldAt(double stamp_s) const {
  return visibleAt(scene_.world, stamp_s - kFirstStamp_s);
}

}  // namespace flight_corridor::sim
