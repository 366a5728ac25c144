#pragma once

#include <message_filters/pass_through.h>
#include <message_filters/synchronizer.h>
#include <ros/console.h>
#include <rosbag/message_instance.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "ros/heartbeat.hpp"
#include "tools/bag_file.hpp"
#include "tools/compressed_image.hpp"
#include "tools/stereo_bag_reader.hpp"

namespace flight_corridor::tools {

/// Left, right and their infos, put together by the stamps in their headers.
/// @tparam Policy of message_filters: exact or approximate time.
template <typename Policy>
class PairBuilder {
 public:
  using CameraInfo = sensor_msgs::CameraInfo;
  using CompressedImage = sensor_msgs::CompressedImage;
  using Image = sensor_msgs::Image;

  PairBuilder(const rosbag::Bag& bag, const StereoTopics& topics, const Rectification& rectification,
              const Policy& policy, std::function<void(const RecordedPair&)> on_pair)
      : bag_(bag),
        rectification_(rectification),
        synchronizer_(policy, left_, left_info_, right_, right_info_),
        on_pair_(std::move(on_pair)) {
    heard_[0].topic = topics.left;
    heard_[1].topic = topics.left_info;
    heard_[2].topic = topics.right;
    heard_[3].topic = topics.right_info;
    synchronizer_.registerCallback(&PairBuilder::handOut, this);
  }

  void add(const rosbag::MessageInstance& message, const ros::Time& recorded) {
    now_ = recorded;
    const std::string topic = message.getTopic();
    const auto& cameras = rectification_.cameras;
    if (topic == heard_[0].topic) addImage(message, 0, left_, cameras ? &cameras->left : nullptr, left_info_);
    if (topic == heard_[1].topic) add(read<CameraInfo>(bag_, message), heard_[1], left_info_);
    if (topic == heard_[2].topic) addImage(message, 2, right_, cameras ? &cameras->right : nullptr, right_info_);
    if (topic == heard_[3].topic) add(read<CameraInfo>(bag_, message), heard_[3], right_info_);
  }

  /// Of the messages so far. Data given in a file is never missing.
  PairStamps heard() const {
    PairStamps heard = heard_;
    if (rectification_.cameras) heard[1].stamps = heard[3].stamps = heard_[0].stamps;
    return heard;
  }

 private:
  template <typename Message>
  void add(const boost::shared_ptr<Message>& message, TopicStamps& heard,
           message_filters::PassThrough<Message>& partner) {
    heard.stamps.push_back(message->header.stamp);
    if (flight_corridor_ros::isPossible(message->header.stamp)) {
      partner.add(ros::MessageEvent<const Message>(message, now_));
    }
  }

  /// @param camera of a file, to go with the image; null: it comes as CameraInfo.
  void addImage(const rosbag::MessageInstance& message, std::size_t place, message_filters::PassThrough<Image>& partner,
                const CameraInfo* camera, message_filters::PassThrough<CameraInfo>& info_partner) {
    const sensor_msgs::ImagePtr image = readImage(message);
    if (image->header.frame_id.empty()) image->header.frame_id = rectification_.frame;
    add(image, heard_[place], partner);
    if (!camera) return;
    const auto info = boost::make_shared<CameraInfo>(*camera);
    info->header = image->header;
    add(info, heard_[place + 1], info_partner);
  }

  sensor_msgs::ImagePtr readImage(const rosbag::MessageInstance& message) {
    if (!message.isType<CompressedImage>()) return read<Image>(bag_, message);
    const auto compressed = read<CompressedImage>(bag_, message);
    const sensor_msgs::ImagePtr image = decompress(*compressed);
    if (image->data.empty() && image_warning_.due()) {
      ROS_WARN(
          "%s: the image of %.3f cannot be decoded (format \"%s\", %zu bytes): damaged, cut off, or not an image of 8 "
          "or 16 bit. Its pair is UNKNOWN",
          message.getTopic().c_str(), compressed->header.stamp.toSec(), compressed->format.c_str(),
          compressed->data.size());
    }
    return image;
  }

  void handOut(const sensor_msgs::ImageConstPtr& left, const sensor_msgs::CameraInfoConstPtr& left_info,
               const sensor_msgs::ImageConstPtr& right, const sensor_msgs::CameraInfoConstPtr& right_info) {
    const StereoMessages pair(left, left_info, right, right_info);
    on_pair_({rectification_.is_raw ? rectifier_.rectify(pair) : pair, now_});
  }

  const rosbag::Bag& bag_;
  const Rectification& rectification_;
  PairRectifier rectifier_;
  message_filters::PassThrough<Image> left_, right_;
  message_filters::PassThrough<CameraInfo> left_info_, right_info_;
  message_filters::Synchronizer<Policy> synchronizer_;
  std::function<void(const RecordedPair&)> on_pair_;
  PairStamps heard_;
  ros::Time now_;
  flight_corridor_ros::Throttle image_warning_;
};

}  // namespace flight_corridor::tools
