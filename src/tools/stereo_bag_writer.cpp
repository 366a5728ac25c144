#include "tools/stereo_bag_writer.hpp"

#include <sensor_msgs/Imu.h>
#include <sensor_msgs/Range.h>
#include <sensor_msgs/image_encodings.h>
#include <tf2_eigen/tf2_eigen.h>
#include <tf2_msgs/TFMessage.h>

#include "ros/conversions.hpp"
#include "tools/stereo_cameras.hpp"

namespace flight_corridor::tools {
namespace {

constexpr char kWorldFrame[] = "odom";
constexpr char kBodyFrame[] = "base_link";
constexpr char kCameraFrame[] = "stereo_left_optical";
constexpr char kRangeFrame[] = "range_link";
const ros::Duration kImageDelay(0.001);  // images are recorded after readings and poses of the same stamp

geometry_msgs::TransformStamped stampedTransform(const Eigen::Isometry3d& T_parent_child, const ros::Time& stamp,
                                                 const std::string& parent, const std::string& child) {
  geometry_msgs::TransformStamped message = tf2::eigenToTransform(T_parent_child);
  message.header.stamp = stamp;
  message.header.frame_id = parent;
  message.child_frame_id = child;
  return message;
}

sensor_msgs::ImagePtr imageMessage(const std_msgs::Header& header, const cv::Mat& image) {
  namespace encodings = sensor_msgs::image_encodings;
  return flight_corridor_ros::toImage(header, image, image.channels() == 1 ? encodings::MONO8 : encodings::BGR8);
}

}  // namespace

StereoBagWriter::StereoBagWriter(const std::string& path, const BagRig& rig, const ros::Time& start) : bag_(path) {
  const StereoCameras cameras = camerasOf(rig.calibration);
  left_info_ = cameras.left;
  right_info_ = cameras.right;
  left_info_.header.frame_id = right_info_.header.frame_id = kCameraFrame;
  writeStaticTransforms(rig, start);
}

void StereoBagWriter::writeStaticTransforms(const BagRig& rig, const ros::Time& start) {
  tf2_msgs::TFMessage message;
  message.transforms = {stampedTransform(rig.T_B_C, start, kBodyFrame, kCameraFrame),
                        stampedTransform(rig.T_B_L, start, kBodyFrame, kRangeFrame)};
  const auto header = boost::make_shared<ros::M_string>();
  (*header)["type"] = ros::message_traits::datatype(message);
  (*header)["md5sum"] = ros::message_traits::md5sum(message);
  (*header)["message_definition"] = ros::message_traits::definition(message);
  (*header)["latching"] = "1";  // rosbag play then hands it to late subscribers
  bag_.write(kStaticTransformTopic, start, message, header);
}

void StereoBagWriter::writePose(const ros::Time& stamp, const Eigen::Isometry3d& T_W_B) {
  tf2_msgs::TFMessage message;
  message.transforms = {stampedTransform(T_W_B, stamp, kWorldFrame, kBodyFrame)};
  bag_.write(kTransformTopic, stamp, message);
}

void StereoBagWriter::writePair(const ros::Time& stamp, const cv::Mat& left, const cv::Mat& right) {
  const ros::Time recorded = stamp + kImageDelay;
  left_info_.header.stamp = right_info_.header.stamp = stamp;
  bag_.write(topics_.left_info, recorded, left_info_);
  bag_.write(topics_.right_info, recorded, right_info_);
  bag_.write(topics_.left, recorded, imageMessage(left_info_.header, left));
  bag_.write(topics_.right, recorded, imageMessage(right_info_.header, right));
}

void StereoBagWriter::writeRange(const ros::Time& stamp, const RangeReading& reading) {
  sensor_msgs::Range message;
  message.header.stamp = stamp;
  message.header.frame_id = kRangeFrame;
  message.radiation_type = sensor_msgs::Range::INFRARED;
  message.field_of_view = static_cast<float>(reading.field_of_view_rad);
  message.min_range = static_cast<float>(reading.min_range_m);
  message.max_range = static_cast<float>(reading.max_range_m);
  message.range = static_cast<float>(reading.range_m);
  bag_.write(topics_.range, stamp, message);
}

void StereoBagWriter::writeImu(const ros::Time& stamp, const Eigen::Vector3d& specific_force_B_mps2,
                               const std::optional<Attitude>& attitude) {
  sensor_msgs::Imu message;
  message.header.stamp = stamp;
  message.header.frame_id = kBodyFrame;
  if (attitude) {
    message.orientation = tf2::toMsg(attitude->R_W_B);
    tf2::toMsg(attitude->angular_velocity_B_rad_s, message.angular_velocity);
  } else {  // the message's way to say "none"
    message.orientation_covariance[0] = message.angular_velocity_covariance[0] = -1.0;
  }
  tf2::toMsg(specific_force_B_mps2, message.linear_acceleration);
  bag_.write(topics_.imu, stamp, message);
}

}  // namespace flight_corridor::tools
