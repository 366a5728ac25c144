#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"
#include "tools/new_bag.hpp"
#include "tools/stereo_topics.hpp"

namespace flight_corridor::tools {

/// A rig as its bag announces it. Frames: odom -> base_link (/tf), base_link -> stereo_left_optical, range_link
/// (/tf_static).
struct BagRig {
  StereoCalibration calibration;
  Eigen::Isometry3d T_B_C = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_B_L = Eigen::Isometry3d::Identity();
};

/// Measurements of an imu in base_link besides the specific force.
struct Attitude {
  Eigen::Quaterniond R_W_B = Eigen::Quaterniond::Identity();
  Eigen::Vector3d angular_velocity_B_rad_s = Eigen::Vector3d::Zero();
};

/// Writes a flight as a bag: messages are recorded at their own stamps, images 1 ms later, so that readings and poses
/// of the same stamp come before them. Write in any order, close() last.
class StereoBagWriter {
 public:
  /// @throws std::runtime_error naming the file when it cannot be written, as all the others.
  StereoBagWriter(const std::string& path, const BagRig& rig, const ros::Time& start);

  void writePose(const ros::Time& stamp, const Eigen::Isometry3d& T_W_B);
  /// @param left, right CV_8UC1 or CV_8UC3 (BGR).
  void writePair(const ros::Time& stamp, const cv::Mat& left, const cv::Mat& right);
  void writeRange(const ros::Time& stamp, const RangeReading& reading);
  /// @param specific_force_B_mps2 acceleration less gravity's, in base_link: (0, 0, 9.8) at rest.
  /// @param attitude absent: marked as missing in the message.
  void writeImu(const ros::Time& stamp, const Eigen::Vector3d& specific_force_B_mps2,
                const std::optional<Attitude>& attitude = std::nullopt);
  void close() { bag_.finish(); }

 private:
  void writeStaticTransforms(const BagRig& rig, const ros::Time& start);

  NewBag bag_;
  StereoTopics topics_;
  sensor_msgs::CameraInfo left_info_, right_info_;
};

}  // namespace flight_corridor::tools
