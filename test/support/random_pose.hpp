#pragma once

#include <Eigen/Geometry>
#include <random>

namespace flight_corridor::test_support {

/// Any orientation; each coordinate of the place within reach_m.
inline Eigen::Isometry3d randomPose(std::mt19937& random, double reach_m) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = reach_m * Eigen::Vector3d(unit(random), unit(random), unit(random));
  pose.rotate(Eigen::Quaterniond(unit(random), unit(random), unit(random), unit(random)).normalized());
  return pose;
}

}  // namespace flight_corridor::test_support
