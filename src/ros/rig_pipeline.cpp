#include "ros/rig_pipeline.hpp"

#include <ros/console.h>

#include <stdexcept>

#include "ros/conversions.hpp"

namespace flight_corridor_ros {

namespace {

using flight_corridor::StereoCalibration;
using flight_corridor::StereoGeometry;

bool same(const StereoCalibration& a, const StereoCalibration& b) {
  return a.size_px == b.size_px && a.fx_px == b.fx_px && a.fy_px == b.fy_px && a.cx_px == b.cx_px &&
         a.cy_px == b.cy_px && a.cx_right_px == b.cx_right_px && a.baseline_m == b.baseline_m;
}

}  // namespace

std::uint32_t RigPipeline::fit(const StereoMessages& pair, const std::string& lidar_frame) try {
  const StereoCalibration calibration = toCalibration(*pair.left_info, *pair.right_info);
  if (pipeline_ && !same(calibration, pipeline_->geometry().calibration())) pipeline_.reset();
  if (mount(pair.left->header.frame_id, lidar_frame)) pipeline_.reset();
  if (!T_C_F_) return flight_corridor::kNoPose;
  if (pipeline_) return 0;
  pipeline_.emplace(config_, StereoGeometry(calibration), flight_corridor::Rig{T_C_L_, *T_C_F_});
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
  pipeline_.reset();
  return flight_corridor::kBadCalibration;
}

/// Looks up the fixed poses that are not known yet.  @return whether one changed.
bool RigPipeline::mount(const std::string& camera_frame, const std::string& lidar_frame) {
  const bool other_rig = camera_frame != camera_frame_ || lidar_frame != lidar_frame_;
  if (other_rig) T_C_L_ = T_C_F_ = std::nullopt;
  camera_frame_ = camera_frame;
  lidar_frame_ = lidar_frame;
  bool changed = other_rig;
  if (!T_C_F_) {
    const std::string& corridor_frame = config_.corridor.frame_id;
    T_C_F_ = corridor_frame.empty() ? flight_corridor::opticalFromForward()
                                    : transforms_.find(camera_frame, corridor_frame, ros::Time(0));
    if (!T_C_F_) warnOfMissing(camera_frame, corridor_frame, "the corridor has no place");
    changed = true;
  }
  if (!T_C_L_ && !lidar_frame.empty()) {
    T_C_L_ = transforms_.find(camera_frame, lidar_frame, ros::Time(0));
    if (!T_C_L_) warnOfMissing(camera_frame, lidar_frame, "LiDAR readings are not used");
    changed = changed || T_C_L_;
  }
  return changed;
}

void RigPipeline::warnOfMissing(const std::string& camera_frame, const std::string& other_frame,
                                const char* consequence) {
  if (!warning_.due()) return;
  ROS_WARN("tf knows no pose of \"%s\" in \"%s\", so %s: publish it, e.g. with tf2_ros static_transform_publisher",
           other_frame.c_str(), camera_frame.c_str(), consequence);
}

}  // namespace flight_corridor_ros
