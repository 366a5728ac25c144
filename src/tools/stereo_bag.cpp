#include "tools/stereo_bag.hpp"

#include <message_filters/pass_through.h>
#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>
#include <rosbag/view.h>
#include <sensor_msgs/distortion_models.h>
#include <sensor_msgs/image_encodings.h>
#include <tf2_eigen/tf2_eigen.h>
#include <tf2_msgs/TFMessage.h>

#include <cstdint>
#include <exception>
#include <fstream>
#include <map>
#include <stdexcept>
#include <vector>

#include "ros/conversions.hpp"

namespace flight_corridor::tools {
namespace {

constexpr char kWorldFrame[] = "odom";
constexpr char kBodyFrame[] = "base_link";
constexpr char kCameraFrame[] = "stereo_left_optical";
constexpr char kRangeFrame[] = "range_link";
constexpr char kTransformTopic[] = "/tf";
constexpr char kStaticTransformTopic[] = "/tf_static";
const ros::Duration kImageDelay(0.001);  // images are recorded after readings and poses of the same stamp

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw std::runtime_error(path + ": " + what);
}

[[noreturn]] void failDamaged(const std::string& path, const std::string& what) {
  fail(path, "cannot be read: " + what + "; if it is damaged or was cut off: rosbag reindex " + path);
}

/// @throws std::runtime_error naming the file when it is missing or something else than a bag.
void requireBag(const std::string& path) {
  const std::string magic = "#ROSBAG ";
  std::string begin(magic.size(), ' ');
  std::ifstream file(path, std::ios::binary);
  if (!file) fail(path, "cannot be read");
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (begin != magic) fail(path, "cannot be read: is no bag");
}

/// @throws std::runtime_error naming the bag and the topic when the message is damaged or of another type.
template <typename Message>
boost::shared_ptr<Message> read(const rosbag::Bag& bag, const rosbag::MessageInstance& message) {
  boost::shared_ptr<Message> read;
  try {
    read = message.instantiate<Message>();
  } catch (const std::exception& error) {
    failDamaged(bag.getFileName(), "topic " + message.getTopic() + ": " + error.what());
  }
  if (!read) {
    fail(bag.getFileName(), "topic " + message.getTopic() + " holds " + message.getDataType() + " besides " +
                                ros::message_traits::datatype<Message>());
  }
  return read;
}

geometry_msgs::TransformStamped stampedTransform(const Eigen::Isometry3d& T_parent_child, const ros::Time& stamp,
                                                 const std::string& parent, const std::string& child) {
  geometry_msgs::TransformStamped message = tf2::eigenToTransform(T_parent_child);
  message.header.stamp = stamp;
  message.header.frame_id = parent;
  message.child_frame_id = child;
  return message;
}

/// @param shift_m position of the camera along +x of the left one.
CameraInfo cameraInfo(const StereoCalibration& calibration, double cx_px, double shift_m) {
  CameraInfo info;
  info.header.frame_id = kCameraFrame;
  info.width = static_cast<std::uint32_t>(calibration.size_px.width);
  info.height = static_cast<std::uint32_t>(calibration.size_px.height);
  const double fx = calibration.fx_px, fy = calibration.fy_px, cy = calibration.cy_px;
  info.distortion_model = sensor_msgs::distortion_models::PLUMB_BOB;
  info.D.resize(5, 0.0);
  info.K = {fx, 0, cx_px, 0, fy, cy, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {fx, 0, cx_px, -fx * shift_m, 0, fy, cy, 0, 0, 0, 1, 0};
  return info;
}

sensor_msgs::ImagePtr imageMessage(const std_msgs::Header& header, const cv::Mat& image) {
  namespace encodings = sensor_msgs::image_encodings;
  return flight_corridor_ros::toImage(header, image, image.channels() == 1 ? encodings::MONO8 : encodings::BGR8);
}

std::map<std::string, std::string> typesByTopic(const rosbag::Bag& bag) {
  rosbag::View view(bag);
  std::map<std::string, std::string> types;
  for (const rosbag::ConnectionInfo* connection : view.getConnections())
    types[connection->topic] = connection->datatype;
  return types;
}

/// Left, right and their infos, put together by the stamps in their headers.
template <typename Policy>
class PairBuilder {
 public:
  PairBuilder(const rosbag::Bag& bag, const Policy& policy, std::function<void(const StereoMessages&)> on_pair)
      : bag_(bag), synchronizer_(policy, left_, left_info_, right_, right_info_), on_pair_(std::move(on_pair)) {
    synchronizer_.registerCallback(&PairBuilder::handOut, this);
  }

  void add(const StereoTopics& topics, const rosbag::MessageInstance& message) {
    if (message.getTopic() == topics.left) left_.add(event<Image>(message));
    if (message.getTopic() == topics.left_info) left_info_.add(event<CameraInfo>(message));
    if (message.getTopic() == topics.right) right_.add(event<Image>(message));
    if (message.getTopic() == topics.right_info) right_info_.add(event<CameraInfo>(message));
  }

 private:
  template <typename Message>
  ros::MessageEvent<const Message> event(const rosbag::MessageInstance& message) const {
    return {boost::shared_ptr<const Message>(read<Message>(bag_, message)), message.getTime()};
  }

  void handOut(const sensor_msgs::ImageConstPtr& left, const sensor_msgs::CameraInfoConstPtr& left_info,
               const sensor_msgs::ImageConstPtr& right, const sensor_msgs::CameraInfoConstPtr& right_info) {
    on_pair_({left, left_info, right, right_info});
  }

  const rosbag::Bag& bag_;
  message_filters::PassThrough<Image> left_, right_;
  message_filters::PassThrough<CameraInfo> left_info_, right_info_;
  message_filters::Synchronizer<Policy> synchronizer_;
  std::function<void(const StereoMessages&)> on_pair_;
};

template <typename Policy>
void playPairs(const rosbag::Bag& bag, const StereoTopics& topics, const Policy& policy,
               const StereoBagReader::Listener& listener) {
  PairBuilder<Policy> builder(bag, policy, listener.on_pair);
  const std::vector<std::string> wanted{topics.left,       topics.left_info, topics.right,
                                        topics.right_info, topics.range,     topics.imu};
  for (const rosbag::MessageInstance& message : rosbag::View(bag, rosbag::TopicQuery(wanted))) {
    if (message.getTopic() == topics.range) {
      listener.on_range(read<sensor_msgs::Range>(bag, message));
    } else if (message.getTopic() == topics.imu) {
      listener.on_imu(read<sensor_msgs::Imu>(bag, message));
    } else {
      builder.add(topics, message);
    }
  }
}

}  // namespace

StereoBagWriter::StereoBagWriter(const std::string& path, const BagRig& rig, const ros::Time& start) : bag_(path) {
  left_info_ = cameraInfo(rig.calibration, rig.calibration.cx_px, 0.0);
  right_info_ = cameraInfo(rig.calibration, rig.calibration.cx_right_px, rig.calibration.baseline_m);
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

void StereoBagWriter::writeImu(const ros::Time& stamp, const Eigen::Vector3d& specific_force_B_mps2) {
  sensor_msgs::Imu message;
  message.header.stamp = stamp;
  message.header.frame_id = kBodyFrame;
  message.orientation_covariance[0] = message.angular_velocity_covariance[0] = -1.0;  // the message's way to say "none"
  tf2::toMsg(specific_force_B_mps2, message.linear_acceleration);
  bag_.write(topics_.imu, stamp, message);
}

StereoBagReader::StereoBagReader(const std::string& path, const StereoTopics& topics) : path_(path), topics_(topics) {
  requireBag(path);
  try {
    bag_.open(path, rosbag::bagmode::Read);
  } catch (const std::exception& error) {
    failDamaged(path, error.what());
  }
  const std::string image = ros::message_traits::datatype<Image>(), info = ros::message_traits::datatype<CameraInfo>();
  requireTopic(topics.left, image);
  requireTopic(topics.left_info, info);
  requireTopic(topics.right, image);
  requireTopic(topics.right_info, info);
  if (hasRanges()) requireRanges();
  if (has(topics.imu)) requireImu();
  readTransforms();
}

bool StereoBagReader::has(const std::string& topic) const { return typesByTopic(bag_).count(topic) > 0; }

void StereoBagReader::requireTopic(const std::string& topic, const std::string& type) const {
  const std::map<std::string, std::string> types = typesByTopic(bag_);
  const auto found = types.find(topic);
  if (found != types.end() && found->second == type) return;
  std::string message = path_ + ": no topic " + topic + " of type " + type + "; it has";
  if (types.empty()) message += " no messages";
  for (const auto& [name, datatype] : types) message += "\n  " + name + " " + datatype;
  throw std::runtime_error(message);
}

void StereoBagReader::readTransforms() {
  const std::vector<std::string> topics{kTransformTopic, kStaticTransformTopic};
  for (const rosbag::MessageInstance& message : rosbag::View(bag_, rosbag::TopicQuery(topics))) {
    const auto transforms = read<tf2_msgs::TFMessage>(bag_, message);
    const bool fixed = message.getTopic() == kStaticTransformTopic;
    for (const auto& transform : transforms->transforms) transforms_.add(transform, fixed);
  }
}

std::size_t StereoBagReader::leftImages() const { return rosbag::View(bag_, rosbag::TopicQuery(topics_.left)).size(); }

double StereoBagReader::rate() const {
  rosbag::View view(bag_, rosbag::TopicQuery(topics_.left));
  if (view.size() < 2 || view.getEndTime() <= view.getBeginTime()) return kNaN;
  const std::uint64_t duration_ns = view.getEndTime().toNSec() - view.getBeginTime().toNSec();
  return 1e9 * static_cast<double>(view.size() - 1) / static_cast<double>(duration_ns);
}

bool StereoBagReader::hasRanges() const { return has(topics_.range); }

void StereoBagReader::requireRanges() const {
  requireTopic(topics_.range, ros::message_traits::datatype<sensor_msgs::Range>());
}

void StereoBagReader::requireImu() const {
  requireTopic(topics_.imu, ros::message_traits::datatype<sensor_msgs::Imu>());
}

void StereoBagReader::play(const flight_corridor_ros::RosConfig& pairing, const Listener& listener) const {
  using Exact = message_filters::sync_policies::ExactTime<Image, CameraInfo, Image, CameraInfo>;
  using Approximate = message_filters::sync_policies::ApproximateTime<Image, CameraInfo, Image, CameraInfo>;
  const auto queue = static_cast<std::uint32_t>(pairing.sync_queue);
  if (!pairing.approximate_sync) return playPairs(bag_, topics_, Exact(queue), listener);
  Approximate policy(queue);
  policy.setMaxIntervalDuration(ros::Duration(pairing.sync_slop_s));
  playPairs(bag_, topics_, policy, listener);
}

}  // namespace flight_corridor::tools
