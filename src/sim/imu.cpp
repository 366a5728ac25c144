#include "sim/imu.hpp"

namespace flight_corridor::sim {
namespace {

// Standard deviations of a reading, each axis.
constexpr double kForceNoise_mps2 = 0.05;
constexpr double kGyroNoise_rad_s = 0.005;
constexpr double kAttitudeNoise_rad = 0.003;  // a sixth of a degree

Eigen::Vector3d noiseOfAxes(Random& random, double std) {
  return Eigen::Vector3d{random.normal(std), random.normal(std), random.normal(std)};  // braces: in this order
}

}  // namespace

ImuReading Imu::measure(double stamp_s, const Eigen::Matrix3d& R_W_B, const Eigen::Vector3d& acceleration_W_mps2,
                        const Eigen::Vector3d& angular_velocity_B_rad_s) {
  constexpr double kGravity_mps2 = 9.80665;
  const Eigen::Vector3d force_noise = noiseOfAxes(force_noise_, kForceNoise_mps2);
  const Eigen::Vector3d rate_noise = noiseOfAxes(attitude_noise_, kGyroNoise_rad_s);
  const Eigen::Vector3d tilt = noiseOfAxes(attitude_noise_, kAttitudeNoise_rad);
  return {stamp_s, R_W_B.transpose() * (acceleration_W_mps2 + kGravity_mps2 * Eigen::Vector3d::UnitZ()) + force_noise,
          angular_velocity_B_rad_s + rate_noise,
          Eigen::Quaterniond(R_W_B) * Eigen::AngleAxisd(tilt.norm(), tilt.normalized())};
}

}  // namespace flight_corridor::sim
