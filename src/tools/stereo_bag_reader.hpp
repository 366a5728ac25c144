#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/Range.h>
#include <tf2_msgs/TFMessage.h>

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ros/params.hpp"
#include "ros/stereo_subscriber.hpp"
#include "tools/lost_pairs.hpp"
#include "tools/pair_rectifier.hpp"
#include "tools/stereo_topics.hpp"

namespace flight_corridor::tools {

using flight_corridor_ros::StereoMessages;

/// A stereo pair, and when the last of its messages was recorded, see BagReading.
struct RecordedPair : StereoMessages {
  RecordedPair(const StereoMessages& messages, const ros::Time& recorded)
      : StereoMessages(messages), recorded(recorded) {}

  ros::Time recorded;
};

/// Data missing in a bag.
struct BagReading {
  std::vector<std::string> calibration_files = {};  ///< In place of CameraInfos; see readCalibration.
  ImageState images = ImageState::AsNamed;
  std::optional<Eigen::Isometry3d> T_F_L = {};  ///< LiDAR in frame F at the left camera: x forward, y left, z up.
  PairNames cameras = {};                       ///< In these files, where they name their cameras.
  bool by_stamps = false;  ///< Use the stamps as times of recording, which a conversion may have lost.
};

/// How images become rectified pairs.
struct Rectification {
  std::optional<StereoCameras> cameras = {};  ///< Those of a file; else the bag's CameraInfos.
  bool is_raw = false;
  std::string frame = {};  ///< For images without one.
};

/// Reads a bag as the node would hear it. Raw images are rectified.
class StereoBagReader {
 public:
  /// Opens the bag. An image topic that is not in it as sensor_msgs/Image is read as sensor_msgs/CompressedImage, under
  /// its own name or with "/compressed" behind it.
  /// @param topics those that are empty are found by type and name, see findTopics.
  /// @throws std::runtime_error naming the file when it is damaged, and the topic that is not in it or has another
  /// type, with the existing topics; and a calibration that cannot rectify raw images.
  StereoBagReader(const std::string& path, const StereoTopics& topics, const BagReading& reading = {});

  /// Two lines: which topics are read, and whether their images are rectified here; the calibration.
  std::string describe() const;

  /// Number of left images, the upper bound of the number of pairs.
  std::size_t leftImages() const;
  /// Mean rate of the left images [Hz]; NaN with fewer than two.
  double rate() const;
  /// Whether there are ranges in the bag: they may be missing.
  bool hasRanges() const;
  /// @throws std::runtime_error like the constructor if there are none.
  void requireRanges() const;
  /// @throws std::runtime_error like the constructor if there is none: it is optional.
  void requireImu() const;
  void requireOdometry() const;

  struct Listener {
    std::function<void(const RecordedPair& pair)> on_pair;
    std::function<void(const sensor_msgs::RangeConstPtr& range)> on_range;
    std::function<void(const sensor_msgs::ImuConstPtr& imu)> on_imu = [](const auto&) {};
    std::function<void(const nav_msgs::Odometry& odometry)> on_odometry = [](const auto&) {};
    std::function<void(const geometry_msgs::TransformStamped& transform, bool is_static)> on_transform = [](const auto&,
                                                                                                            bool) {};
  };
  /// Hands out pairs, ranges, imu readings and transforms in the order of recording; transforms come early by the time
  /// for which the node waits for them. An image that cannot be decoded is empty, and a warning says so.
  /// @param config approximate_sync, sync_slop_s and sync_queue: how the messages of a pair find each other;
  /// tf_timeout_s.
  /// @return the stamps of all messages that could form pairs.
  /// @throws std::runtime_error naming file and topic of a message that is damaged or of another type.
  PairStamps play(const flight_corridor_ros::RosConfig& config, const Listener& listener) const;

 private:
  using OnMessage = std::function<void(const rosbag::MessageInstance& message, const ros::Time& recorded)>;
  struct RecordedTransforms {
    ros::Time recorded;
    tf2_msgs::TFMessageConstPtr message;
    bool is_static;
  };

  bool has(const std::string& topic) const;
  bool holds(const std::string& topic, const std::string& type) const;
  void forEach(const std::vector<std::string>& topics, const OnMessage& on_message) const;
  void readCalibrationFiles();
  void readCameraInfos();
  geometry_msgs::TransformStamped mounting() const;
  std::string findImages(const std::string& named) const;
  void requireTopic(const std::string& topic, const std::string& type) const;
  void readTransforms();
  template <typename Policy>
  PairStamps playPairs(const Policy& policy, const ros::Duration& tf_timeout, const Listener& listener) const;

  StereoTopics topics_;
  BagReading reading_;
  Rectification rectification_;
  std::string calibration_;  ///< In words.
  rosbag::Bag bag_;
  std::vector<RecordedTransforms> transforms_;
};

}  // namespace flight_corridor::tools
