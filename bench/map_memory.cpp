// Memory of the map over a simulated hour of flight: poses on a lap of 5.4 km
// through a wood and depth frames at 10 Hz, straight into the map. With the
// rolling window it stays flat after the first minute.
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <vector>

#include "../test/support/exact_depth.hpp"
#include "flight_corridor/map/occupancy_map.hpp"
#include "sim/rig.hpp"

namespace {

using namespace flight_corridor;

constexpr double kRate_hz = 10.0;
constexpr int kMinutes = 60;
constexpr double kSpeed_mps = 1.5;
constexpr double kLapRadius_m = kSpeed_mps * 60.0 * kMinutes / (2.0 * M_PI);  // one lap an hour
constexpr double kSpacing_m = 4.0;                                            // of the trees
constexpr double kImageScale = 0.25;                                          // 160 x 120

/// Along the lap, looking to both sides of it, up and down.
Eigen::Isometry3d bodyPose(double time_s) {
  const double bearing_rad = kSpeed_mps / kLapRadius_m * time_s;
  Eigen::Isometry3d T_W_B = Eigen::Isometry3d::Identity();
  T_W_B.translation() = Eigen::Vector3d(kLapRadius_m * std::cos(bearing_rad), kLapRadius_m * std::sin(bearing_rad),
                                        1.5 + 0.3 * std::sin(0.21 * time_s));
  const double yaw_rad = bearing_rad + M_PI / 2.0 + 0.5 * std::sin(0.4 * time_s);
  const double pitch_rad = 0.1 * std::sin(0.9 * time_s), roll_rad = 0.1 * std::sin(0.7 * time_s);
  T_W_B.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  T_W_B.rotate(Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()));
  T_W_B.rotate(Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX()));
  return T_W_B;
}

/// The same number in [0, 1) for the same place, any other elsewhere.
double chance(double x, double y, double salt) {
  const double wild = 43758.5453 * std::sin(12.9898 * x + 78.233 * y + 37.719 * salt);
  return wild - std::floor(wild);
}

/// Ground and the trees that the camera may see within the map's range.
std::vector<sim::Primitive> worldAhead(const Eigen::Isometry3d& T_W_C, double range_m) {
  const Eigen::Vector3d here_W = T_W_C.translation(), ahead_W = T_W_C.linear().col(2);
  std::vector<sim::Primitive> world{sim::makeBox({here_W.x(), here_W.y(), -0.5}, {100, 100, 1}, {})};
  const double column = std::round(here_W.x() / kSpacing_m), row = std::round(here_W.y() / kSpacing_m);
  const int reach = static_cast<int>(std::ceil(range_m / kSpacing_m));
  for (int i = -reach; i <= reach; ++i) {
    for (int j = -reach; j <= reach; ++j) {
      const double x = column + i, y = row + j;
      const Eigen::Vector3d foot_W(kSpacing_m * (x + 0.8 * chance(x, y, 1)), kSpacing_m * (y + 0.8 * chance(x, y, 2)),
                                   0.0);
      const Eigen::Vector3d to_W = foot_W - here_W;
      const double depth_m = ahead_W.dot(to_W), beside_m = (to_W - depth_m * ahead_W).head<2>().norm();
      if (depth_m < 0.8 || depth_m > range_m + 1.0 || beside_m > depth_m + 0.5) continue;
      const double radius_m = 0.05 + 0.25 * chance(x, y, 3);
      world.push_back(sim::makeCylinder(foot_W, foot_W + Eigen::Vector3d(0, 0, 6.0), radius_m, {}));
    }
  }
  return world;
}

StereoGeometry smallGeometry() {
  sim::Rig rig = sim::defaultRig();
  sim::scaleImages(rig, kImageScale);
  return StereoGeometry(rig.calibration);
}

/// What the process holds of the machine's memory.
double residentMb() {
  std::size_t size = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> size >> resident;
  return 1e-6 * static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace

int main() {
  const StereoGeometry geometry = smallGeometry();
  const Eigen::Isometry3d T_B_C = sim::defaultRig().T_B_C;
  MapConfig config;
  config.frame_id = "odom";
  OccupancyMap map(config, geometry);
  double first_mb = 0.0, largest_mb = 0.0;
  std::printf("minute   leaves   tree [MB]   process [MB]\n");
  const int frames_a_minute = static_cast<int>(60.0 * kRate_hz);
  for (int frame = 1; frame <= kMinutes * frames_a_minute; ++frame) {
    const double time_s = frame / kRate_hz;
    const Eigen::Isometry3d T_W_C = bodyPose(time_s) * T_B_C;
    map.keepAround(T_W_C.translation(), time_s);
    map.insert(test_support::exactDepth(worldAhead(T_W_C, config.max_range_m), geometry, T_W_C), T_W_C);
    if (frame % frames_a_minute != 0) continue;
    const double tree_mb = 1e-6 * static_cast<double>(map.tree().memoryUsage());
    if (frame == frames_a_minute) first_mb = tree_mb;
    largest_mb = std::max(largest_mb, tree_mb);
    std::printf("%6d %8zu %11.2f %14.1f\n", frame / frames_a_minute, map.tree().getNumLeafNodes(), tree_mb,
                residentMb());
    std::fflush(stdout);
  }
  std::printf("largest tree: %.2f times that of the first minute\n", largest_mb / first_mb);
}
