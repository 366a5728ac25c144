#include "ros/rig_pipeline.hpp"

#include <ros/console.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "ros/conversions.hpp"

namespace flight_corridor_ros {

namespace {

using flight_corridor::Pipeline;
using flight_corridor::StereoCalibration;
using flight_corridor::StereoGeometry;

/// Less than any match tells: a calibration that is computed anew for each image jitters in its last bits.
constexpr double kSame_px = 1e-3, kSame_m = 1e-6;

bool same(const StereoCalibration& a, const StereoCalibration& b) {
  const auto differ = [&](double StereoCalibration::*value) { return std::abs(a.*value - b.*value); };
  return a.size_px == b.size_px && differ(&StereoCalibration::fx_px) <= kSame_px &&
         differ(&StereoCalibration::fy_px) <= kSame_px && differ(&StereoCalibration::cx_px) <= kSame_px &&
         differ(&StereoCalibration::cy_px) <= kSame_px && differ(&StereoCalibration::cx_right_px) <= kSame_px &&
         differ(&StereoCalibration::baseline_m) <= kSame_m;
}

}  // namespace

std::uint32_t RigPipeline::fit(const StereoMessages& pair, const std::string& lidar_frame) try {
  const StereoCalibration calibration = toCalibration(*pair.left_info, *pair.right_info);
  rig_changed_ |= mountLidar(pair.left->header.frame_id, lidar_frame);
  const auto T_C_F = forward(pair.left->header);
  if (!T_C_F) return flight_corridor::kNoPose;
  if (is_fit_ && !rig_changed_ && same(calibration, pipeline_->geometry().calibration())) {
    pipeline_->pointAlong(*T_C_F);
    return 0;
  }
  auto pipeline =
      std::make_unique<Pipeline>(config_, StereoGeometry(calibration), flight_corridor::Rig{T_C_L_, *T_C_F});
  if (pipeline_) pipeline->takeOver(*pipeline_);
  pipeline_ = std::move(pipeline);
  is_fit_ = true;
  rig_changed_ = false;
  ROS_INFO("%dx%d px, f %.1f px, baseline %.4f m, %s", calibration.size_px.width, calibration.size_px.height,
           calibration.fx_px, calibration.baseline_m, T_C_L_ ? ("LiDAR " + lidar_frame_).c_str() : "no LiDAR");
  if (const double nearest_m = pipeline_->nearestDepth(); nearest_m > config_.corridor.blind_m) {
    ROS_WARN(
        "stereo sees nothing nearer than %.2f m, beyond %.2f m (corridor/blind_m): an obstacle between the two is "
        "not seen, the corridor may be FREE. A larger stereo/num_disparities_px sees nearer",
        nearest_m, config_.corridor.blind_m);
  }
  return 0;
} catch (const std::invalid_argument& error) {
  if (warning_.due()) {
    ROS_ERROR("no verdict from camera \"%s\" with LiDAR \"%s\": %s", pair.left->header.frame_id.c_str(),
              lidar_frame.c_str(), error.what());
  }
  is_fit_ = false;
  return flight_corridor::kBadCalibration;
}

void RigPipeline::reset() {
  camera_frame_.clear();
  lidar_frame_.clear();
  T_C_L_.reset();
  pipeline_.reset();
  is_fit_ = false;
}

/// Looks up the LiDAR's fixed pose until it is known. Other range sensors on the topic are none of the rig's.
/// @return whether the rig is another one now.
bool RigPipeline::mountLidar(const std::string& camera_frame, const std::string& lidar_frame) {
  const bool other_camera = camera_frame != camera_frame_;
  if (T_C_L_ && !other_camera) return false;
  camera_frame_ = camera_frame;
  lidar_frame_ = lidar_frame;
  T_C_L_ = lidar_frame.empty() ? std::nullopt : transforms_.find(camera_frame, lidar_frame, ros::Time(0));
  if (!T_C_L_ && !lidar_frame.empty() && lidar_warning_.due()) {
    ROS_WARN(
        "tf knows no pose of \"%s\" in \"%s\", so LiDAR readings are not used: publish it, e.g. with tf2_ros "
        "static_transform_publisher",
        lidar_frame.c_str(), camera_frame.c_str());
  }
  return other_camera || T_C_L_;
}

/// Where the corridor points at a pair's stamp, T_C_F: its frame may turn against the camera.
std::optional<Eigen::Isometry3d> RigPipeline::forward(const std_msgs::Header& camera) {
  const std::string& frame = config_.corridor.frame_id;
  if (frame.empty()) return flight_corridor::opticalFromForward();
  const auto T_C_F = transforms_.find(camera.frame_id, frame, camera.stamp, tf_timeout_s_);
  if (!T_C_F && warning_.due()) {
    ROS_WARN(
        "tf gave no pose of \"%s\" (corridor/frame_id) in \"%s\" at %.3f within %.3f s (ros/tf_timeout_s): UNKNOWN",
        frame.c_str(), camera.frame_id.c_str(), camera.stamp.toSec(), tf_timeout_s_);
  }
  return T_C_F;
}

}  // namespace flight_corridor_ros
