#include "tools/stereo_bag_reader.hpp"

#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/sync_policies/exact_time.h>
#include <nav_msgs/Odometry.h>
#include <ros/console.h>
#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/image_encodings.h>
#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"
#include "ros/transforms.hpp"
#include "tools/bag_file.hpp"
#include "tools/calibration_file.hpp"
#include "tools/compressed_image.hpp"
#include "tools/pair_builder.hpp"
#include "tools/topic_finder.hpp"

namespace flight_corridor::tools {
namespace {

/// With which every message that is read here begins.
struct Beginning {
  std_msgs::Header header;
};

}  // namespace
}  // namespace flight_corridor::tools

namespace ros {

using flight_corridor::tools::Beginning;

template <>
struct message_traits::MD5Sum<Beginning> {
  static const char* value() { return "*"; }  // of any type
};
template <>
struct message_traits::DataType<Beginning> {
  static const char* value() { return "*"; }
};
template <>
struct serialization::Serializer<Beginning> {
  template <typename Stream>
  static void read(Stream& stream, Beginning& beginning) {
    stream.next(beginning.header);
  }
};

}  // namespace ros

namespace flight_corridor::tools {
namespace {

using flight_corridor_ros::withoutSlash;
using sensor_msgs::CameraInfo;
using sensor_msgs::CompressedImage;
using sensor_msgs::Image;

template <typename Message>
std::string typeOf() {
  return ros::message_traits::datatype<Message>();
}

constexpr char kLidarFrame[] = "lidar_at_left_camera", kLeftFrame[] = "left_camera";

/// The image of a topic that holds raw or compressed ones; empty where it cannot be decoded.
sensor_msgs::ImagePtr readAnyImage(const rosbag::Bag& bag, const rosbag::MessageInstance& message) {
  return message.isType<CompressedImage>() ? decompress(*read<CompressedImage>(bag, message))
                                           : read<Image>(bag, message);
}

/// @throws std::runtime_error if the topic holds none.
rosbag::MessageInstance first(const rosbag::Bag& bag, const std::string& topic) {
  rosbag::View view(bag, rosbag::TopicQuery(topic));
  if (view.size() == 0) failMissing(bag, "no message of topic " + topic);
  return *view.begin();
}

/// When a transform's message came at the earliest. Those that never change are known from the start.
ros::Time newestStamp(const tf2_msgs::TFMessage& message, bool is_static) {
  ros::Time newest = ros::TIME_MIN;
  for (const auto& transform : message.transforms) {
    const ros::Time& stamp = transform.header.stamp;
    if (!is_static && flight_corridor_ros::isPossible(stamp)) newest = std::max(newest, stamp);
  }
  return newest;
}

}  // namespace

StereoBagReader::StereoBagReader(const std::string& path, const StereoTopics& topics, const BagReading& reading)
    : reading_(reading) {
  openBag(path, bag_);
  const bool has_files = !reading.calibration_files.empty();
  const StereoTopics found = findTopics(bag_, topics, !has_files);
  topics_ = found;
  topics_.left = findImages(found.left);
  if (!has_files) requireTopic(found.left_info, typeOf<CameraInfo>());
  topics_.right = findImages(found.right);
  if (!has_files) requireTopic(found.right_info, typeOf<CameraInfo>());
  if (hasRanges()) requireRanges();
  if (has(topics_.imu)) requireImu();
  if (has(topics_.odom)) requireOdometry();
  if (has_files) {
    topics_.left_info = topics_.right_info = "";  // nothing is read of them
    readCalibrationFiles();
  } else {
    readCameraInfos();
  }
  readTransforms();
}

void StereoBagReader::readCalibrationFiles() {
  const sensor_msgs::ImagePtr image = readAnyImage(bag_, first(bag_, topics_.left));
  if (image->data.empty()) failDamaged(bag_.getFileName(), "topic " + topics_.left + ": the first image is empty");
  const bool is_colour = sensor_msgs::image_encodings::isColor(image->encoding);
  const cv::Size size(static_cast<int>(image->width), static_cast<int>(image->height));
  const StereoCameras cameras =
      readCalibration(reading_.calibration_files, {size, is_colour, {topics_.left, topics_.right}, reading_.cameras});
  rectification_.is_raw = areRaw(reading_.images, topics_.left, cameras);
  if (!rectification_.is_raw && cameras.is_rectification_computed && !areRectified(cameras)) {
    throw std::runtime_error(reading_.calibration_files.front() + ": is of raw images only, not how those of " +
                             topics_.left + " were rectified; if they are raw: --raw");
  }
  rectification_.cameras = rectification_.is_raw ? cameras : rectified(cameras);
  calibration_ = tools::describe(cameras, rectification_.is_raw);
}

void StereoBagReader::readCameraInfos() {
  const StereoCameras cameras{*read<CameraInfo>(bag_, first(bag_, topics_.left_info)),
                              *read<CameraInfo>(bag_, first(bag_, topics_.right_info))};
  rectification_.is_raw = areRaw(reading_.images, topics_.left, cameras);
  calibration_ = tools::describe(cameras, rectification_.is_raw);
  if (!rectification_.is_raw) return;
  try {
    requireRectifiable(cameras);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(bag_.getFileName() + ": the images of " + topics_.left + " cannot be rectified by " +
                             topics_.left_info + ", " + topics_.right_info + ": " + error.what() +
                             ". Give a calibration with --calib; if they are rectified: --rectified");
  }
}

std::string StereoBagReader::describe() const {
  const auto orNone = [&](const std::string& topic) { return has(topic) ? topic : "none"; };
  std::string calibration = topics_.left_info + ", " + topics_.right_info;
  if (rectification_.cameras) {
    calibration.clear();
    for (const std::string& file : reading_.calibration_files) calibration += (calibration.empty() ? "" : ", ") + file;
  }
  return "left " + topics_.left + ", right " + topics_.right +
         (rectification_.is_raw ? ": raw, rectified by " : ": rectified already, calibration of ") + calibration +
         "; range " + orNone(topics_.range) + "; imu " + orNone(topics_.imu) + "; odom " + orNone(topics_.odom) + "\n" +
         calibration_;
}

bool StereoBagReader::has(const std::string& topic) const { return typesByTopic(bag_).count(topic) > 0; }

bool StereoBagReader::holds(const std::string& topic, const std::string& type) const {
  const std::map<std::string, std::string> types = typesByTopic(bag_);
  const auto found = types.find(topic);
  return found != types.end() && found->second == type;
}

/// @return the topic that holds the images of this name.
std::string StereoBagReader::findImages(const std::string& named) const {
  const std::string compressed = named + "/compressed";
  if (holds(named, typeOf<Image>()) || holds(named, typeOf<CompressedImage>())) return named;
  if (holds(compressed, typeOf<CompressedImage>())) return compressed;
  failMissing(bag_, "no topic " + named + " of type " + typeOf<Image>() + ", nor " + compressed + " of type " +
                        typeOf<CompressedImage>());
}

void StereoBagReader::requireTopic(const std::string& topic, const std::string& type) const {
  if (!holds(topic, type)) failMissing(bag_, "no topic " + topic + " of type " + type);
}

void StereoBagReader::readTransforms() {
  if (reading_.T_F_L) rectification_.frame = kLeftFrame;
  const std::set<std::string> moving{kTransformTopic, withoutSlash(kTransformTopic)};
  const std::set<std::string> fixed{kStaticTransformTopic, withoutSlash(kStaticTransformTopic)};
  std::vector<std::string> topics(moving.begin(), moving.end());
  topics.insert(topics.end(), fixed.begin(), fixed.end());
  for (const rosbag::MessageInstance& message : rosbag::View(bag_, rosbag::TopicQuery(topics))) {
    const tf2_msgs::TFMessageConstPtr transforms = read<tf2_msgs::TFMessage>(bag_, message);
    const bool is_static = fixed.count(message.getTopic()) > 0;
    transforms_.push_back(
        {reading_.by_stamps ? newestStamp(*transforms, is_static) : message.getTime(), transforms, is_static});
  }
  std::stable_sort(transforms_.begin(), transforms_.end(),
                   [](const auto& a, const auto& b) { return a.recorded < b.recorded; });
}

/// In the order of recording, or of the stamps; a message without a stamp stays behind its predecessor.
void StereoBagReader::forEach(const std::vector<std::string>& topics, const OnMessage& on_message) const {
  rosbag::View view(bag_, rosbag::TopicQuery(topics));
  if (!reading_.by_stamps) {
    for (const rosbag::MessageInstance& message : view) on_message(message, message.getTime());
    return;
  }
  std::multimap<std::pair<ros::Time, bool>, rosbag::MessageInstance> messages;  // an image comes after equal readings
  ros::Time before = ros::TIME_MIN;
  for (const rosbag::MessageInstance& message : view) {
    const ros::Time stamp = read<Beginning>(bag_, message)->header.stamp;
    if (!stamp.isZero() && flight_corridor_ros::isPossible(stamp)) before = stamp;
    const std::string topic = message.getTopic();
    const bool is_reading = topic == topics_.range || topic == topics_.imu || topic == topics_.odom;
    messages.emplace(std::pair(before, !is_reading), message);
  }
  for (const auto& [place, message] : messages) on_message(message, place.first);
}

std::size_t StereoBagReader::leftImages() const { return rosbag::View(bag_, rosbag::TopicQuery(topics_.left)).size(); }

double StereoBagReader::rate() const {
  ros::Time begin, end;
  std::size_t images = 0;
  forEach({topics_.left}, [&](const rosbag::MessageInstance&, const ros::Time& recorded) {
    if (++images == 1) begin = recorded;
    end = recorded;
  });
  if (end <= begin) return kNaN;
  return 1e9 * static_cast<double>(images - 1) / static_cast<double>(end.toNSec() - begin.toNSec());
}

bool StereoBagReader::hasRanges() const { return has(topics_.range); }

void StereoBagReader::requireRanges() const { requireTopic(topics_.range, typeOf<sensor_msgs::Range>()); }

void StereoBagReader::requireImu() const { requireTopic(topics_.imu, typeOf<sensor_msgs::Imu>()); }

void StereoBagReader::requireOdometry() const { requireTopic(topics_.odom, typeOf<nav_msgs::Odometry>()); }

/// Of the LiDAR, given by hand.
geometry_msgs::TransformStamped StereoBagReader::mounting() const {
  geometry_msgs::TransformStamped mounting = tf2::eigenToTransform(opticalFromForward() * *reading_.T_F_L);
  const std::string frame = withoutSlash(readAnyImage(bag_, first(bag_, topics_.left))->header.frame_id);
  mounting.header.frame_id = frame.empty() ? kLeftFrame : frame;
  mounting.header.stamp = rosbag::View(bag_).getBeginTime();
  mounting.child_frame_id = kLidarFrame;
  return mounting;
}

template <typename Policy>
PairStamps StereoBagReader::playPairs(const Policy& policy, const ros::Duration& tf_timeout,
                                      const Listener& listener) const {
  PairBuilder<Policy> builder(bag_, topics_, rectification_, policy, listener.on_pair);
  if (reading_.T_F_L) listener.on_transform(mounting(), true);
  const std::vector<std::string> wanted{topics_.left,  topics_.left_info, topics_.right, topics_.right_info,
                                        topics_.range, topics_.imu,       topics_.odom};
  auto next = transforms_.begin();
  forEach(wanted, [&](const rosbag::MessageInstance& message, const ros::Time& recorded) {
    for (; next != transforms_.end() && next->recorded <= recorded + tf_timeout; ++next) {
      for (const auto& transform : next->message->transforms) listener.on_transform(transform, next->is_static);
    }
    if (message.getTopic() == topics_.range) {
      const auto range = read<sensor_msgs::Range>(bag_, message);
      if (reading_.T_F_L) range->header.frame_id = kLidarFrame;
      listener.on_range(range);
    } else if (message.getTopic() == topics_.imu) {
      listener.on_imu(read<sensor_msgs::Imu>(bag_, message));
    } else if (message.getTopic() == topics_.odom) {
      listener.on_odometry(*read<nav_msgs::Odometry>(bag_, message));
    } else {
      builder.add(message, recorded);
    }
  });
  return builder.heard();
}

PairStamps StereoBagReader::play(const flight_corridor_ros::RosConfig& config, const Listener& listener) const {
  using Exact = message_filters::sync_policies::ExactTime<Image, CameraInfo, Image, CameraInfo>;
  using Approximate = message_filters::sync_policies::ApproximateTime<Image, CameraInfo, Image, CameraInfo>;
  const auto queue = static_cast<std::uint32_t>(config.sync_queue);
  const ros::Duration tf_timeout(config.tf_timeout_s);
  if (!config.approximate_sync) return playPairs(Exact(queue), tf_timeout, listener);
  Approximate policy(queue);
  policy.setMaxIntervalDuration(ros::Duration(config.sync_slop_s));
  return playPairs(policy, tf_timeout, listener);
}

}  // namespace flight_corridor::tools
