#pragma once

#include <cv_bridge/cv_bridge.h>

#include <optional>

#include "flight_corridor/opencl/opencl_matcher.hpp"
#include "flight_corridor/pipeline.hpp"
#include "ros/conversions.hpp"
#include "ros/imu.hpp"
#include "ros/inbox.hpp"
#include "ros/own_parts_file.hpp"
#include "ros/params.hpp"
#include "ros/rig_pipeline.hpp"
#include "ros/transforms.hpp"
#include "ros/up_direction.hpp"

namespace flight_corridor_ros {

/// The answer to a stereo pair that could not be processed.
flight_corridor::Report refusal(const ros::Time& stamp, std::uint32_t reasons);

/// Whether an answer is a refusal.
bool isRefusal(const flight_corridor::Report& report);

/// From messages to verdicts: the part of the node that needs neither a master nor a clock. One thread.
class Processor {
 public:
  /// @param inbox with the waiting readings of LiDAR and imu.
  /// @throws std::invalid_argument if stereo/mask is no readable image, or if stereo/device is "gpu" and no GPU matches
  /// pairs: requireDevice().
  Processor(const NodeConfig& config, const Transforms& transforms, Inbox& inbox)
      : config_(config),
        transforms_(transforms),
        inbox_(inbox),
        up_(config.ros.gravity_frame, transforms, config.ros.tf_timeout_s),
        rig_(config.core, readOwnParts(config.mask, config.ros.scale), transforms, config.ros.tf_timeout_s, up_),
        accelerometer_(config.ros.gravity_frame, transforms),
        empty_map_(config.core.map.resolution_m) {
    flight_corridor::requireDevice(config.core.stereo, flight_corridor::makeOpenClMatcher);
  }

  /// The verdict for one pair; a stamp more than a second before the newest pair's restarts everything; a smaller step
  /// back, or a missing stamp, is refused.
  const flight_corridor::Report& process(const StereoMessages& pair);

  /// Forgets everything that was seen; the next pair may have any stamp.
  void reset();

  /// Makes a box of the map unknown, in the map's frame.
  void clear(const Eigen::AlignedBox3d& box_M);

  /// Changes the corridor from now on; the evidence is kept.
  /// @throws std::invalid_argument if the rig cannot see it; then nothing has changed.
  void setCorridor(const flight_corridor::CorridorConfig& corridor) { rig_.setCorridor(corridor); }

  /// The pipeline with the last pair's products; null if that pair was refused.
  flight_corridor::Pipeline* products() { return has_products_ ? pipeline() : nullptr; }
  /// Of the present rig; null before its first pair.
  flight_corridor::Pipeline* pipeline() { return rig_ ? &*rig_ : nullptr; }
  /// The answer to the last pair.
  const flight_corridor::Report& report() const { return report_; }
  /// Empty before the first pair.
  const octomap::OcTree& map() { return rig_ ? rig_->map().tree() : empty_map_; }
  /// Edge of its cells [m].
  double cell() const { return empty_map_.getResolution(); }
  /// The map's frame, and the stamp of the last pair that entered the map; 0: no pair did.
  const std_msgs::Header& mapHeader() const { return map_header_; }
  /// The LiDAR's newest reading up to the last pair; null without one, or if no range sensor is the LiDAR.
  sensor_msgs::RangeConstPtr lidar() const { return rig_.hasLidar() ? lidar_ : nullptr; }
  /// Turns vectors of a level frame, x along the corridor's heading, z up, into C at the last pair; nullopt, and a
  /// throttled warning, if the direction of up is unknown, or the corridor has no heading. Needs products().
  std::optional<Eigen::Matrix3d> level();
  /// The last pair's left image at ros/scale, CV_8UC1; empty if it could not be read.
  const cv::Mat& left() const { return left_->image; }
  /// Its CameraInfo at ros/scale; null before the first pair.
  const sensor_msgs::CameraInfoConstPtr& leftInfo() const { return left_info_; }
  /// Of the present pipeline, and of the readings refused before it; all 0 without one.
  flight_corridor::Counters counters();
  /// What contradicted the direction of up when it was last needed, in words; empty: nothing.
  const std::string& attitudeFault() const { return up_.contradiction(); }
  /// See RigPipeline.
  const flight_corridor::MatchingDevice& device() const { return rig_.device(); }

 private:
  void forgetWhenTimeJumpsBack(const ros::Time& stamp);
  std_msgs::Header headerOfMap(const std_msgs::Header& left) const;
  void addReadings(const std_msgs::Header& header, const std::vector<sensor_msgs::ImuConstPtr>& imu_messages);
  void addRange(const sensor_msgs::RangeConstPtr& range);
  void watchRefused(const char* sensor, const Inbox::Refused& refused, std::uint64_t& known);
  void watchLidar(const flight_corridor::RangeReading& reading);
  void explain(const StereoMessages& pair, const cv::Mat& right);
  void explainBlack(const char* side, const cv::Mat& image);
  std::optional<Eigen::Isometry3d> cameraPose(const std_msgs::Header& header);
  std::optional<Eigen::Isometry3d> poseInAnyFrame(const std_msgs::Header& header);
  cv_bridge::CvImageConstPtr readImage(const sensor_msgs::ImageConstPtr& message, const sensor_msgs::CameraInfo& info,
                                       EightOfSixteen bits);

  const NodeConfig config_;
  const Transforms& transforms_;
  Inbox& inbox_;
  UpDirection up_;
  RigPipeline rig_;
  Accelerometer accelerometer_;
  const octomap::OcTree empty_map_;
  std_msgs::Header map_header_, camera_header_;
  flight_corridor::Report report_ = refusal({}, flight_corridor::kNoData);
  sensor_msgs::RangeConstPtr lidar_;
  cv_bridge::CvImageConstPtr left_ = boost::make_shared<cv_bridge::CvImage>();
  sensor_msgs::CameraInfoConstPtr left_info_;
  bool has_products_ = false;
  ros::Time newest_stamp_;
  std::uint64_t refused_ranges_ = 0, refused_imu_ = 0;  // known
  double useful_range_s_ = flight_corridor::kNaN;       // stamp of the newest useful range
  std::string fixed_frame_;                             // in which poses were found first
  Throttle stamp_warning_, lidar_warning_, range_warning_, reading_warning_, image_warning_, match_warning_,
      rows_warning_, black_warning_, pose_warning_, heading_warning_, motion_warning_;
};

}  // namespace flight_corridor_ros
