#include "ros/scans.hpp"

#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <cmath>

#include "ros/transforms.hpp"

namespace flight_corridor_ros {

namespace {

using flight_corridor::kInfinity;
using flight_corridor::kNaN;
using flight_corridor::LevelScan;

constexpr double kNearest_m = 0.1;  // range_min: autopilots ignore what is nearer, so nothing is
constexpr int kBins = 72;           // of MAVLink's OBSTACLE_DISTANCE
constexpr double kBin_rad = 2.0 * M_PI / kBins;
constexpr double kSliver_rad = 0.1 * kBin_rad;  // overlap of a step with a bin by rounding
constexpr double kBeyond_m = 0.015;  // above range_max: a centimetre, when mavros has rounded down to whole ones

std::string scanFrame(const std_msgs::Header& camera) { return withoutSlash(camera.frame_id) + "_scan"; }

double widthOf(const LevelScan& scan) { return static_cast<double>(scan.range_m.size()) * scan.step_rad; }

sensor_msgs::LaserScan scanWithin(const std_msgs::Header& camera, const std::string& frame, double range_max_m) {
  sensor_msgs::LaserScan message;
  message.header.stamp = camera.stamp;
  message.header.frame_id = frame;
  message.range_min = static_cast<float>(kNearest_m);
  message.range_max = static_cast<float>(range_max_m);
  return message;
}

/// The range of the directions up to half a bin beside a yaw, left of the heading: +inf if all are free, NaN if not all
/// are known and none has an obstacle.
double nearestAround(const LevelScan& scan, double yaw_rad) {
  double covered_rad = 0.0, nearest_m = kInfinity;
  bool is_known = true;
  for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
    const double beside_rad = std::abs(scan.first_yaw_rad + static_cast<double>(i) * scan.step_rad - yaw_rad);
    const double shared_rad = std::min({0.5 * (scan.step_rad + kBin_rad) - beside_rad, kBin_rad, scan.step_rad});
    if (shared_rad > 0.0) covered_rad += shared_rad;
    if (shared_rad <= kSliver_rad && shared_rad < scan.step_rad) continue;
    is_known = is_known && !std::isnan(scan.range_m[i]);
    nearest_m = std::fmin(nearest_m, scan.range_m[i]);
  }
  is_known = is_known && covered_rad >= kBin_rad - kSliver_rad;
  return is_known || std::isfinite(nearest_m) ? nearest_m : kNaN;
}

}  // namespace

std::vector<geometry_msgs::TransformStamped> scanFrames(const std_msgs::Header& camera, const Eigen::Matrix3d& R_C_H) {
  const auto frame = [&](const std::string& parent, const std::string& name, const Eigen::Matrix3d& rotation) {
    geometry_msgs::TransformStamped transform = tf2::eigenToTransform(Eigen::Isometry3d(rotation));
    transform.header.stamp = camera.stamp;
    transform.header.frame_id = parent;
    transform.child_frame_id = name;
    return transform;
  };
  const Eigen::Matrix3d R_H_D = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  return {frame(withoutSlash(camera.frame_id), scanFrame(camera), R_C_H),
          frame(scanFrame(camera), scanFrame(camera) + "_frd", R_H_D)};
}

sensor_msgs::LaserScan toScan(const std_msgs::Header& camera, const LevelScan& scan) {
  sensor_msgs::LaserScan message = scanWithin(camera, scanFrame(camera), scan.max_range_m);
  message.angle_min = static_cast<float>(scan.first_yaw_rad);
  message.angle_max = static_cast<float>(scan.first_yaw_rad + widthOf(scan) - scan.step_rad);
  message.angle_increment = static_cast<float>(scan.step_rad);
  for (const double range_m : scan.range_m) {
    message.ranges.push_back(std::isnan(range_m) ? static_cast<float>(kNaN)
                                                 : std::max(static_cast<float>(range_m), message.range_min));
  }
  return message;
}

sensor_msgs::LaserScan toObstacleDistance(const std_msgs::Header& camera, const LevelScan& scan) {
  sensor_msgs::LaserScan message = scanWithin(camera, scanFrame(camera) + "_frd", scan.max_range_m);
  message.angle_increment = static_cast<float>(kBin_rad);
  message.angle_max = static_cast<float>(2.0 * M_PI - kBin_rad);
  for (int bin = 0; bin < kBins; ++bin) {
    const double range_m = nearestAround(scan, std::remainder(-bin * kBin_rad, 2.0 * M_PI));
    const double told_m = range_m == kInfinity ? scan.max_range_m + kBeyond_m : range_m;
    message.ranges.push_back(std::isnan(told_m) ? static_cast<float>(kNaN)
                                                : std::max(static_cast<float>(told_m), message.range_min));
  }
  return message;
}

}  // namespace flight_corridor_ros
