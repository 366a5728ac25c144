#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <std_msgs/Header.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "ros/heartbeat.hpp"
#include "ros/transforms.hpp"
#include "ros/up_direction.hpp"

namespace flight_corridor_ros {

/// The pipeline for the rig described by CameraInfo and tf, rebuilt when the cameras change. One thread.
class RigPipeline {
 public:
  /// @param own_parts in the images to process.  @param tf_timeout_s longest wait for the corridor's frame.
  /// @param up for a level corridor.
  RigPipeline(const flight_corridor::Config& config, flight_corridor::OwnParts own_parts, const Transforms& transforms,
              double tf_timeout_s, UpDirection& up)
      : config_(config),
        own_parts_(std::move(own_parts)),
        transforms_(transforms),
        tf_timeout_s_(tf_timeout_s),
        up_(up) {}

  /// Makes the pipeline fit a stereo pair. The LiDAR is the first range sensor that tf knows and whose beam ends in the
  /// camera's view, else the first that points ahead; it stays the LiDAR while that holds, at its newest pose in tf.
  /// @param camera the left image's header, its frame without a leading slash.
  /// @param left_info, right_info of the images to process.
  /// @param range_frames of the range sensors, without a leading slash.
  /// @return why there is no pipeline: 0, kBadCalibration or kNoPose.
  std::uint32_t fit(const std_msgs::Header& camera, const sensor_msgs::CameraInfo& left_info,
                    const sensor_msgs::CameraInfo& right_info, const std::vector<std::string>& range_frames);

  /// Whether readings of this frame are the LiDAR's.
  bool isLidar(const std::string& frame) const { return hasLidar() && withoutSlash(frame) == lidar_frame_; }
  bool hasLidar() const { return T_C_L_.has_value(); }

  /// After a pair: warns once if the requested GPU does not match pairs; later rigs do not use it.
  void watchDevice();

  /// Where the last pair was matched, and the failure of any rig so far.
  const flight_corridor::MatchingDevice& device() const { return device_; }
  /// Valid after fit() returned 0.
  flight_corridor::Pipeline& operator*() { return *pipeline_; }
  flight_corridor::Pipeline* operator->() { return &*pipeline_; }
  explicit operator bool() const { return is_fit_; }

  /// Changes the corridor, see Pipeline::setCorridor().
  /// @throws std::invalid_argument if the rig cannot see it; then nothing has changed.
  void setCorridor(const flight_corridor::CorridorConfig& corridor);

  /// Forgets everything, also the LiDAR's frame.
  void reset();

 private:
  void findLidar(const flight_corridor::StereoGeometry& geometry, const std::string& camera_frame,
                 std::vector<std::string> range_frames);
  void mount(const std::string& range_frame, const Eigen::Isometry3d& T_C_L);
  void make(const flight_corridor::StereoGeometry& geometry, const Eigen::Isometry3d& T_C_F);
  std::optional<Eigen::Isometry3d> forward(const std_msgs::Header& camera);
  std::optional<Eigen::Isometry3d> frameOfCorridor(const std_msgs::Header& camera);

  flight_corridor::Config config_;
  const flight_corridor::OwnParts own_parts_;
  const Transforms& transforms_;
  double tf_timeout_s_;
  UpDirection& up_;
  std::string camera_frame_, lidar_frame_;
  std::optional<Eigen::Isometry3d> T_C_L_;
  bool lidar_moved_ = false;  // since the pipeline got its pose
  std::unique_ptr<flight_corridor::Pipeline> pipeline_;
  bool is_fit_ = false;  // else pipeline_ is only kept for when its rig, or another, comes
  flight_corridor::MatchingDevice device_;
  Throttle warning_, lidar_warning_, level_warning_;
};

}  // namespace flight_corridor_ros
