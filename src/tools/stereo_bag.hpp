#pragma once

#include <rosbag/bag.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/Range.h>

#include <Eigen/Geometry>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <string>

#include "flight_corridor/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"
#include "ros/params.hpp"
#include "ros/stereo_subscriber.hpp"
#include "ros/transforms.hpp"
#include "tools/new_bag.hpp"

namespace flight_corridor::tools {

/// Where a bag holds the rig's data.
struct StereoTopics {
  std::string left = "/stereo/left/image_rect";
  std::string left_info = "/stereo/left/camera_info";
  std::string right = "/stereo/right/image_rect";
  std::string right_info = "/stereo/right/camera_info";
  std::string range = "/range";
  std::string imu = "/imu";
};

/// A rig as its bag announces it. Frames: odom -> base_link (/tf), base_link -> stereo_left_optical, range_link
/// (/tf_static).
struct BagRig {
  StereoCalibration calibration;
  Eigen::Isometry3d T_B_C = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_B_L = Eigen::Isometry3d::Identity();
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
  /// Orientation and angular velocity are left out.
  /// @param specific_force_B_mps2 acceleration less gravity's, in base_link: (0, 0, 9.8) at rest.
  void writeImu(const ros::Time& stamp, const Eigen::Vector3d& specific_force_B_mps2);
  void close() { bag_.finish(); }

 private:
  void writeStaticTransforms(const BagRig& rig, const ros::Time& start);

  NewBag bag_;
  StereoTopics topics_;
  sensor_msgs::CameraInfo left_info_, right_info_;
};

using flight_corridor_ros::StereoMessages;

/// Reads a bag as the node would hear it.
class StereoBagReader {
 public:
  /// Opens the bag and reads all of its /tf and /tf_static.
  /// @throws std::runtime_error naming the file when it is damaged, and the topic that is not in it or has another
  /// type, with what is there.
  StereoBagReader(const std::string& path, const StereoTopics& topics);

  const flight_corridor_ros::Transforms& transforms() const { return transforms_; }
  /// Number of left images, the upper bound of the number of pairs.
  std::size_t leftImages() const;
  /// Mean rate of the left images [Hz]; NaN with fewer than two.
  double rate() const;
  /// Whether there are ranges in the bag: they may be missing.
  bool hasRanges() const;
  /// @throws std::runtime_error like the constructor when there are none.
  void requireRanges() const;
  /// @throws std::runtime_error like the constructor when there is none: it may be missing.
  void requireImu() const;

  struct Listener {
    std::function<void(const StereoMessages& messages)> on_pair;
    std::function<void(const sensor_msgs::RangeConstPtr& range)> on_range;
    std::function<void(const sensor_msgs::ImuConstPtr& imu)> on_imu = [](const auto&) {};
  };
  /// Hands out pairs, ranges and imu readings in the order of recording.
  /// @param pairing approximate_sync, sync_slop_s and sync_queue: how the messages of a pair find each other.
  /// @throws std::runtime_error naming file and topic of a message that is damaged or of another type.
  void play(const flight_corridor_ros::RosConfig& pairing, const Listener& listener) const;

 private:
  bool has(const std::string& topic) const;
  void requireTopic(const std::string& topic, const std::string& type) const;
  void readTransforms();

  std::string path_;
  StereoTopics topics_;
  rosbag::Bag bag_;
  flight_corridor_ros::Transforms transforms_;
};

}  // namespace flight_corridor::tools
