#pragma once

#include <sensor_msgs/Imu.h>

#include <Eigen/Geometry>
#include <deque>
#include <optional>
#include <string>

namespace flight_corridor_ros {

/// Holds a claimed direction of up against what an imu felt in the last two seconds. Model: the mean specific force f =
/// a - g points up, for a vehicle's own accelerations are smaller than gravity or average out; and up stays where it is
/// while the imu turns by its angular velocity. An attitude that is constant (identity, yaw alone) is noticed by the
/// turn alone: in a co-ordinated turn the force is along the body's z, and if that is wide, nothing tells. One thread.
class AttitudeWatch {
 public:
  /// @param up_I the claim, in the imu's frame at the message's stamp; a unit vector.
  void add(const sensor_msgs::Imu& message, const Eigen::Vector3d& up_I);

  /// What contradicts the claims, in words with angle and limit; nullopt: nothing. A claim that was contradicted for a
  /// second is not believed for ten more.
  std::optional<std::string> contradiction();

  void reset();

 private:
  struct Sample {
    double stamp_s;
    Eigen::Vector3d up_G, force_G, rate_I;  // G: the imu's frame once, kept by its rates; NaN: not in the message
  };

  std::optional<std::string> contradictionNow() const;

  std::deque<Sample> samples_;
  std::string frame_;  // I
  Eigen::Quaterniond R_G_I_ = Eigen::Quaterniond::Identity();
  std::string last_;                  // contradiction that was sure
  std::optional<double> believed_s_;  // stamp from which the claims are believed again
};

}  // namespace flight_corridor_ros
