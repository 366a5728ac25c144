#include "ros/rig_pipeline.hpp"

#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "flight_corridor/opencl/opencl_matcher.hpp"
#include "ros/conversions.hpp"

namespace flight_corridor_ros {

namespace {

using flight_corridor::BeamFootprint;
using flight_corridor::Pipeline;
using flight_corridor::StereoCalibration;
using flight_corridor::StereoGeometry;

/// Less than any match resolves: a calibration that is recomputed for each image jitters in its last bits.
constexpr double kSame_px = 1e-3, kSame_m = 1e-6;
constexpr double kSameMounting = 1e-9;  // relative: rounding of tf
constexpr double kNarrowest_px = 3.0;   // thin obstacles are seen at 4.4 px, and missed now and then at 2.2 px

bool same(const StereoCalibration& a, const StereoCalibration& b) {
  const auto differ = [&](double StereoCalibration::*value) { return std::abs(a.*value - b.*value); };
  return a.size_px == b.size_px && differ(&StereoCalibration::fx_px) <= kSame_px &&
         differ(&StereoCalibration::fy_px) <= kSame_px && differ(&StereoCalibration::cx_px) <= kSame_px &&
         differ(&StereoCalibration::cy_px) <= kSame_px && differ(&StereoCalibration::cx_right_px) <= kSame_px &&
         differ(&StereoCalibration::baseline_m) <= kSame_m;
}

}  // namespace

std::uint32_t RigPipeline::fit(const std_msgs::Header& camera, const sensor_msgs::CameraInfo& left_info,
                               const sensor_msgs::CameraInfo& right_info,
                               const std::vector<std::string>& range_frames) try {
  const StereoGeometry geometry(toCalibration(left_info, right_info));
  const std::string& camera_frame = camera.frame_id;
  findLidar(geometry, camera_frame, range_frames);
  const auto T_C_F = forward(camera);
  if (!T_C_F) return flight_corridor::kNoPose;
  const bool is_same =
      pipeline_ && camera_frame == camera_frame_ && same(geometry.calibration(), pipeline_->geometry().calibration());
  if (!is_same) {
    make(geometry, *T_C_F);
  } else if (!is_fit_) {
    pipeline_->setCorridor(config_.corridor);  // it may have changed in between
  }
  camera_frame_ = camera_frame;
  is_fit_ = true;
  if (std::exchange(lidar_moved_, false)) pipeline_->mountLidar(T_C_L_);
  pipeline_->pointAlong(*T_C_F);
  return 0;
} catch (const std::invalid_argument& error) {
  if (warning_.due()) {
    ROS_ERROR("no verdict from camera \"%s\": %s", camera.frame_id.c_str(), error.what());
  }
  is_fit_ = false;
  return flight_corridor::kBadCalibration;
}

void RigPipeline::make(const StereoGeometry& geometry, const Eigen::Isometry3d& T_C_F) {
  auto pipeline = std::make_unique<Pipeline>(config_, geometry, flight_corridor::Rig{T_C_L_, T_C_F, own_parts_},
                                             flight_corridor::makeOpenClMatcher);
  if (pipeline_) pipeline->takeOver(*pipeline_);
  pipeline_ = std::move(pipeline);
  const StereoCalibration& calibration = geometry.calibration();
  ROS_INFO("%dx%d px, f %.1f px, baseline %.4f m, matched on %s", calibration.size_px.width, calibration.size_px.height,
           calibration.fx_px, calibration.baseline_m, pipeline_->matchingDevice().name.c_str());
  if (const std::string doubts = flight_corridor::doubtsOf(calibration); !doubts.empty()) {
    ROS_WARN(
        "CameraInfo is unusual: %s. If it is of other images, depth and position are wrong, and a FREE may be, too",
        doubts.c_str());
  }
  if (!pipeline_->seesFromBlind()) {
    ROS_WARN(
        "stereo sees nothing nearer than %.2f m, beyond %.2f m (corridor/blind_m): the space between is unobserved, "
        "which counts against FREE. Raise stereo/num_disparities_px (%d), or set corridor/blind_m if nothing comes so "
        "near",
        pipeline_->nearestDepth(), config_.corridor.blind_m, config_.stereo.num_disparities_px);
  }
  const flight_corridor::CorridorConfig& corridor = config_.corridor;
  const double smallest_px = calibration.fx_px * corridor.smallest_obstacle_m / corridor.length_m;
  if (smallest_px > 0.0 && smallest_px < kNarrowest_px) {
    ROS_WARN(
        "corridor/smallest_obstacle_m (%.2f m) is %.1f px wide at the corridor's end: obstacles so thin may be missed. "
        "Use larger images (ros/scale), or a shorter corridor/length_m: %.0f px are needed",
        corridor.smallest_obstacle_m, smallest_px, kNarrowest_px);
  }
}

void RigPipeline::watchDevice() {
  const auto& [name, failure] = pipeline_->matchingDevice();
  device_.name = name;
  if (failure.empty() || !device_.failure.empty()) return;
  ROS_WARN("from now on pairs are matched on the CPU (stereo/device: %s): %s", config_.stereo.device.c_str(),
           failure.c_str());
  device_.failure = failure;
  config_.stereo.device = "cpu";
}

void RigPipeline::setCorridor(const flight_corridor::CorridorConfig& corridor) {
  if (is_fit_) pipeline_->setCorridor(corridor);
  config_.corridor = corridor;
}

void RigPipeline::reset() {
  camera_frame_.clear();
  lidar_frame_.clear();
  T_C_L_.reset();
  pipeline_.reset();
  is_fit_ = false;
}

/// One whose beam ends in view, else one that looks ahead; the one that is known already before others.
void RigPipeline::findLidar(const StereoGeometry& geometry, const std::string& camera_frame,
                            std::vector<std::string> range_frames) {
  std::stable_partition(range_frames.begin(), range_frames.end(), [this](const auto& frame) { return isLidar(frame); });
  for (const bool must_end_in_view : {true, false}) {
    for (const std::string& frame : range_frames) {
      const auto T_C_L = transforms_.find(camera_frame, frame, ros::Time(0));
      if (!T_C_L || !BeamFootprint::looksAhead(*T_C_L)) continue;
      if (!must_end_in_view || BeamFootprint::endsInView(config_.lidar, geometry, *T_C_L)) return mount(frame, *T_C_L);
    }
  }
  if (hasLidar()) lidar_moved_ = true;
  T_C_L_.reset();
  if (!range_frames.empty() && lidar_warning_.due()) {
    const bool is_known = transforms_.find(camera_frame, range_frames[0], ros::Time(0)).has_value();
    ROS_WARN(
        "ranges of \"%s\" are not used: %s camera \"%s\". Publish its mounting (beam along +x), e.g. with tf2_ros "
        "static_transform_publisher",
        range_frames[0].c_str(),
        range_frames[0].empty() ? "they name no frame (header.frame_id), so tf does not connect them with"
        : is_known              ? "the beam is not within 60 deg of the optical axis of"
                                : "tf does not connect that frame with",
        camera_frame.c_str());
  }
}

void RigPipeline::mount(const std::string& range_frame, const Eigen::Isometry3d& T_C_L) {
  if (!isLidar(range_frame)) ROS_INFO("LiDAR \"%s\"", range_frame.c_str());
  lidar_moved_ |= !isLidar(range_frame) || !T_C_L.isApprox(*T_C_L_, kSameMounting);
  lidar_frame_ = range_frame;
  T_C_L_ = T_C_L;
}

/// The corridor's frame at a pair's stamp, T_C_F.
std::optional<Eigen::Isometry3d> RigPipeline::forward(const std_msgs::Header& camera) {
  auto T_C_F = frameOfCorridor(camera);
  if (!T_C_F || !config_.corridor.level) return T_C_F;
  const auto up_C = up_.find(camera);  // warns
  if (!up_C) return std::nullopt;
  const auto R_C_H = levelled(T_C_F->linear(), *up_C);
  if (R_C_H) {
    T_C_F->linear() = *R_C_H;
    return T_C_F;
  }
  if (level_warning_.due()) {
    ROS_WARN("the corridor points straight up or down, where it has no heading (corridor/level): UNKNOWN");
  }
  return std::nullopt;
}

/// Its frame may turn relative to the camera.
std::optional<Eigen::Isometry3d> RigPipeline::frameOfCorridor(const std_msgs::Header& camera) {
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
