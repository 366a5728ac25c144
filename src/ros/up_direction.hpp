#pragma once

#include <sensor_msgs/Imu.h>
#include <std_msgs/Header.h>

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <string>

#include "ros/attitude_watch.hpp"
#include "ros/heartbeat.hpp"
#include "ros/transforms.hpp"

namespace flight_corridor_ros {

/// R_C_H of the level frame H, x along the heading of F, z up: F without roll and pitch.
/// @param up_C direction of up, a unit vector.
/// @return nullopt if F points more than 80 degrees up or down: it has no heading.
std::optional<Eigen::Matrix3d> levelled(const Eigen::Matrix3d& R_C_F, const Eigen::Vector3d& up_C);

/// Direction of up in the imu's frame, by its orientation (REP-145: of the imu in a fixed frame, z up).
/// @return nullopt if the message has no orientation (covariance[0] = -1), or it is not a unit quaternion.
std::optional<Eigen::Vector3d> toUp(const sensor_msgs::Imu& message);

/// Direction of up, from tf or the imu's attitude. One thread.
class UpDirection {
 public:
  /// @param gravity_frame a fixed frame of tf, z up.
  /// @param tf_timeout_s longest wait for it, if tf knows it at all and there is no imu.
  UpDirection(const std::string& gravity_frame, const Transforms& transforms, double tf_timeout_s)
      : gravity_frame_(gravity_frame), transforms_(transforms), tf_timeout_s_(tf_timeout_s) {}

  /// A message of the imu; the newest that holds an attitude counts.
  void add(const sensor_msgs::ImuConstPtr& imu);

  /// Unit vector in the camera's frame C at its stamp: by tf, else by an imu message within 0.1 s.
  /// @return nullopt, and a throttled warning, if neither knows, or what the imu measures contradicts it.
  std::optional<Eigen::Vector3d> find(const std_msgs::Header& camera);

  /// What contradicted the last direction, in words; empty: nothing.
  const std::string& contradiction() const { return contradiction_; }

  /// Forgets the imu.
  void reset();

 private:
  std::optional<Eigen::Vector3d> byTf(const std_msgs::Header& camera, double timeout_s) const;
  std::optional<Eigen::Vector3d> byImu(const std_msgs::Header& camera) const;
  bool isContradicted(bool is_by_tf);
  void watchTf();
  void warnUnknown(const std_msgs::Header& camera, bool tf_knows_it);

  std::string gravity_frame_;
  const Transforms& transforms_;
  double tf_timeout_s_;
  sensor_msgs::ImuConstPtr imu_;
  std::deque<sensor_msgs::ImuConstPtr> not_watched_;  // of which tf's attitude was not asked yet
  AttitudeWatch imu_watch_, tf_watch_;
  std::string contradiction_;
  Throttle warning_, contradiction_warning_;
};

}  // namespace flight_corridor_ros
