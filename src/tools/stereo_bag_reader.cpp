#include "tools/stereo_bag_reader.hpp"

#include <message_filters/pass_through.h>
#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>
#include <ros/console.h>
#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>

#include <cstdint>
#include <utility>

#include "flight_corridor/types.hpp"
#include "ros/heartbeat.hpp"
#include "ros/transforms.hpp"
#include "tools/bag_file.hpp"
#include "tools/compressed_image.hpp"

namespace flight_corridor::tools {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::CompressedImage;
using sensor_msgs::Image;

template <typename Message>
std::string typeOf() {
  return ros::message_traits::datatype<Message>();
}

/// Left, right and their infos, put together by the stamps in their headers.
template <typename Policy>
class PairBuilder {
 public:
  PairBuilder(const rosbag::Bag& bag, const StereoTopics& topics, const Policy& policy,
              std::function<void(const RecordedPair&)> on_pair)
      : bag_(bag), synchronizer_(policy, left_, left_info_, right_, right_info_), on_pair_(std::move(on_pair)) {
    heard_[0].topic = topics.left;
    heard_[1].topic = topics.left_info;
    heard_[2].topic = topics.right;
    heard_[3].topic = topics.right_info;
    synchronizer_.registerCallback(&PairBuilder::handOut, this);
  }

  void add(const rosbag::MessageInstance& message) {
    now_ = message.getTime();
    const std::string topic = message.getTopic();
    if (topic == heard_[0].topic) add(readImage(message), heard_[0], left_);
    if (topic == heard_[1].topic) add(read<CameraInfo>(bag_, message), heard_[1], left_info_);
    if (topic == heard_[2].topic) add(readImage(message), heard_[2], right_);
    if (topic == heard_[3].topic) add(read<CameraInfo>(bag_, message), heard_[3], right_info_);
  }

  /// Of what came so far.
  const PairStamps& heard() const { return heard_; }

 private:
  template <typename Message>
  void add(const boost::shared_ptr<Message>& message, TopicStamps& heard,
           message_filters::PassThrough<Message>& partner) {
    heard.stamps.push_back(message->header.stamp);
    if (flight_corridor_ros::isPossible(message->header.stamp)) {
      partner.add(ros::MessageEvent<const Message>(message, now_));
    }
  }

  sensor_msgs::ImagePtr readImage(const rosbag::MessageInstance& message) {
    if (!message.isType<CompressedImage>()) return read<Image>(bag_, message);
    const auto compressed = read<CompressedImage>(bag_, message);
    const sensor_msgs::ImagePtr image = decompress(*compressed);
    if (image->data.empty() && image_warning_.due()) {
      ROS_WARN(
          "%s: the image of %.3f cannot be decoded (format \"%s\", %zu bytes): damaged, cut off, or no image of 8 or "
          "16 bit. Its pair is UNKNOWN",
          message.getTopic().c_str(), compressed->header.stamp.toSec(), compressed->format.c_str(),
          compressed->data.size());
    }
    return image;
  }

  void handOut(const sensor_msgs::ImageConstPtr& left, const sensor_msgs::CameraInfoConstPtr& left_info,
               const sensor_msgs::ImageConstPtr& right, const sensor_msgs::CameraInfoConstPtr& right_info) {
    on_pair_({StereoMessages(left, left_info, right, right_info), now_});
  }

  const rosbag::Bag& bag_;
  message_filters::PassThrough<Image> left_, right_;
  message_filters::PassThrough<CameraInfo> left_info_, right_info_;
  message_filters::Synchronizer<Policy> synchronizer_;
  std::function<void(const RecordedPair&)> on_pair_;
  PairStamps heard_;
  ros::Time now_;
  flight_corridor_ros::Throttle image_warning_;
};

}  // namespace

StereoBagReader::StereoBagReader(const std::string& path, const StereoTopics& topics) : topics_(topics) {
  openBag(path, bag_);
  topics_.left = findImages(topics.left);
  requireTopic(topics.left_info, typeOf<CameraInfo>());
  topics_.right = findImages(topics.right);
  requireTopic(topics.right_info, typeOf<CameraInfo>());
  if (hasRanges()) requireRanges();
  if (has(topics.imu)) requireImu();
  readTransforms();
}

bool StereoBagReader::has(const std::string& topic) const { return typesByTopic(bag_).count(topic) > 0; }

/// @return the topic that holds the images of this name.
std::string StereoBagReader::findImages(const std::string& named) const {
  const std::map<std::string, std::string> types = typesByTopic(bag_);
  const auto holds = [&](const std::string& topic, const std::string& type) {
    const auto found = types.find(topic);
    return found != types.end() && found->second == type;
  };
  const std::string compressed = named + "/compressed";
  if (holds(named, typeOf<Image>()) || holds(named, typeOf<CompressedImage>())) return named;
  if (holds(compressed, typeOf<CompressedImage>())) return compressed;
  failMissing(bag_, "no topic " + named + " of type " + typeOf<Image>() + ", nor " + compressed + " of type " +
                        typeOf<CompressedImage>());
}

void StereoBagReader::requireTopic(const std::string& topic, const std::string& type) const {
  const std::map<std::string, std::string> types = typesByTopic(bag_);
  const auto found = types.find(topic);
  if (found != types.end() && found->second == type) return;
  failMissing(bag_, "no topic " + topic + " of type " + type);
}

void StereoBagReader::readTransforms() {
  const std::vector<std::string> topics{kTransformTopic, kStaticTransformTopic};
  for (const rosbag::MessageInstance& message : rosbag::View(bag_, rosbag::TopicQuery(topics))) {
    transforms_.push_back(
        {message.getTime(), read<tf2_msgs::TFMessage>(bag_, message), message.getTopic() == kStaticTransformTopic});
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

void StereoBagReader::requireRanges() const { requireTopic(topics_.range, typeOf<sensor_msgs::Range>()); }

void StereoBagReader::requireImu() const { requireTopic(topics_.imu, typeOf<sensor_msgs::Imu>()); }

template <typename Policy>
PairStamps StereoBagReader::playPairs(const Policy& policy, const ros::Duration& tf_timeout,
                                      const Listener& listener) const {
  PairBuilder<Policy> builder(bag_, topics_, policy, listener.on_pair);
  const std::vector<std::string> wanted{topics_.left,       topics_.left_info, topics_.right,
                                        topics_.right_info, topics_.range,     topics_.imu};
  auto next = transforms_.begin();
  for (const rosbag::MessageInstance& message : rosbag::View(bag_, rosbag::TopicQuery(wanted))) {
    for (; next != transforms_.end() && next->recorded <= message.getTime() + tf_timeout; ++next) {
      for (const auto& transform : next->message->transforms) listener.on_transform(transform, next->is_static);
    }
    if (message.getTopic() == topics_.range) {
      listener.on_range(read<sensor_msgs::Range>(bag_, message));
    } else if (message.getTopic() == topics_.imu) {
      listener.on_imu(read<sensor_msgs::Imu>(bag_, message));
    } else {
      builder.add(message);
    }
  }
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
