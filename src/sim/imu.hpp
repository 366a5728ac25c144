#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "sim/random.hpp"

namespace flight_corridor::sim {

/// The measurements of an ideal imu in B, with noise.
struct ImuReading {
  double stamp_s = 0.0;
  Eigen::Vector3d specific_force_B_mps2 = Eigen::Vector3d::Zero();  ///< Acceleration less gravity's.
  Eigen::Vector3d angular_velocity_B_rad_s = Eigen::Vector3d::Zero();
  Eigen::Quaterniond R_W_B = Eigen::Quaterniond::Identity();  ///< Attitude.
};

/// An imu's noise.
class Imu {
 public:
  explicit Imu(std::uint64_t seed)
      : force_noise_(seed, Stream::ImuNoise), attitude_noise_(seed, Stream::AttitudeNoise) {}

  /// f = R_B_W (a - g) and its other measurements.
  /// @param R_W_B true attitude.
  ImuReading measure(double stamp_s, const Eigen::Matrix3d& R_W_B, const Eigen::Vector3d& acceleration_W_mps2,
                     const Eigen::Vector3d& angular_velocity_B_rad_s);

 private:
  Random force_noise_, attitude_noise_;
};

}  // namespace flight_corridor::sim
