#include "ros/processor.hpp"

#include <ros/console.h>

#include <stdexcept>

#include "ros/conversions.hpp"

namespace flight_corridor_ros {

namespace {

constexpr std::uint32_t kRefused =
    flight_corridor::kNoData | flight_corridor::kNoPose | flight_corridor::kBadImage | flight_corridor::kBadCalibration;

}  // namespace

flight_corridor::Report refusal(const ros::Time& stamp, std::uint32_t reasons) {
  flight_corridor::Report report;
  report.verdict.stamp_s = stamp.toSec();
  report.verdict.reasons = reasons;
  return report;
}

bool isRefusal(const flight_corridor::Report& report) { return (report.verdict.reasons & kRefused) != 0; }

const flight_corridor::Report& Processor::process(const StereoMessages& pair) {
  const std_msgs::Header& header = pair.left->header;
  has_products_ = false;
  report_ = refusal(header.stamp, flight_corridor::kNoData);  // for questions, should a library throw
  if (header.stamp.isZero()) {
    if (stamp_warning_.due()) ROS_WARN("a stereo pair has no stamp (0): UNKNOWN");
    return report_;
  }
  forgetWhenTimeJumpsBack(header.stamp);
  if (header.stamp < newest_stamp_) {
    if (stamp_warning_.due()) ROS_WARN("a stereo pair is older than the one before: UNKNOWN");
    return report_;
  }
  newest_stamp_ = header.stamp;
  const auto lidar = inbox_.newestRange();
  if (const std::uint32_t reasons = rig_.fit(pair, lidar ? lidar->header.frame_id : "")) {
    return report_ = refusal(header.stamp, reasons);
  }
  addReadings(header);
  left_ = readImage(pair.left);
  const auto right = readImage(pair.right);
  report_ = rig_->process({header.stamp.toSec(), left_->image, right->image}, cameraPose(header));
  has_products_ = !isRefusal(report_);
  if (has_products_) map_header_ = headerOfMap(header);
  return report_;
}

void Processor::reset() {
  rig_.reset();
  lidar_.reset();
  has_products_ = false;
  report_ = refusal({}, flight_corridor::kNoData);
  map_header_.stamp = newest_stamp_ = ros::Time();
}

void Processor::clear(const Eigen::AlignedBox3d& box_M) {
  if (rig_) rig_->clear(box_M);
}

std_msgs::Header Processor::headerOfMap(const std_msgs::Header& left) const {
  std_msgs::Header header = left;
  if (!config_.core.map.frame_id.empty()) header.frame_id = config_.core.map.frame_id;
  return header;
}

void Processor::forgetWhenTimeJumpsBack(const ros::Time& stamp) {
  const double back_s = newest_stamp_.toSec() - stamp.toSec();
  if (back_s <= kLongestDelay_s) return;
  if (rig_) ROS_INFO("time jumped back by %.3f s: starting anew", back_s);
  reset();
}

/// Readings up to an image. Accelerations first: ranges need them to be predicted.
void Processor::addReadings(const std_msgs::Header& header) {
  for (const auto& imu : inbox_.takeImu(header.stamp)) {
    const auto acceleration_C = accelerometer_.read(*imu, header.frame_id);
    if (acceleration_C) rig_->addAcceleration(imu->header.stamp.toSec(), *acceleration_C);
  }
  for (const auto& range : inbox_.takeRanges(header.stamp)) {
    if (rig_.isLidar(range->header.frame_id)) {
      lidar_ = range;
      rig_->addRange(toReading(*range));
    } else if (lidar_warning_.due()) {
      ROS_WARN("ranges of \"%s\" are not used: they are not of the LiDAR's frame", range->header.frame_id.c_str());
    }
  }
}

std::optional<Eigen::Isometry3d> Processor::cameraPose(const std_msgs::Header& header) {
  const std::string& map_frame = config_.core.map.frame_id;
  if (map_frame.empty()) return std::nullopt;
  const auto T_W_C = transforms_.find(map_frame, header.frame_id, header.stamp, config_.ros.tf_timeout_s);
  if (!T_W_C && pose_warning_.due()) {
    ROS_WARN("tf gave no pose of \"%s\" in \"%s\" (map/frame_id) at %.3f within %.3f s (ros/tf_timeout_s): UNKNOWN",
             header.frame_id.c_str(), map_frame.c_str(), header.stamp.toSec(), config_.ros.tf_timeout_s);
  }
  return T_W_C;
}

/// An empty image when the message is none: the pipeline answers BAD_IMAGE.
cv_bridge::CvImageConstPtr Processor::readImage(const sensor_msgs::ImageConstPtr& message) try {
  return toGrey(message);
} catch (const std::invalid_argument& error) {
  if (image_warning_.due()) ROS_ERROR("%s", error.what());
  return boost::make_shared<cv_bridge::CvImage>();
}

}  // namespace flight_corridor_ros
