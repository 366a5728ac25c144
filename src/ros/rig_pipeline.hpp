#pragma once

#include <optional>
#include <string>

#include "flight_corridor/pipeline.hpp"
#include "ros/heartbeat.hpp"
#include "ros/stereo_subscriber.hpp"
#include "ros/transforms.hpp"

namespace flight_corridor_ros {

/// The pipeline for the rig that CameraInfo and tf describe, made anew when either changes. One thread.
class RigPipeline {
 public:
  RigPipeline(const flight_corridor::Config& config, const Transforms& transforms)
      : config_(config), transforms_(transforms) {}

  /// Makes the pipeline fit a stereo pair and the LiDAR's frame ("": no LiDAR yet).
  /// @return why there is no pipeline: 0, kBadCalibration or kNoPose.
  std::uint32_t fit(const StereoMessages& pair, const std::string& lidar_frame);

  /// Valid after fit() returned 0.
  flight_corridor::Pipeline& operator*() { return *pipeline_; }
  flight_corridor::Pipeline* operator->() { return &*pipeline_; }
  explicit operator bool() const { return pipeline_.has_value(); }

 private:
  bool mount(const std::string& camera_frame, const std::string& lidar_frame);
  void warnOfMissing(const std::string& camera_frame, const std::string& other_frame, const char* consequence);

  flight_corridor::Config config_;
  const Transforms& transforms_;
  std::string camera_frame_, lidar_frame_;
  std::optional<Eigen::Isometry3d> T_C_L_, T_C_F_;
  std::optional<flight_corridor::Pipeline> pipeline_;
  Throttle warning_;
};

}  // namespace flight_corridor_ros
