#pragma once

#include <image_transport/subscriber_filter.h>
#include <message_filters/pass_through.h>
#include <message_filters/subscriber.h>
#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>
#include <ros/node_handle.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/Header.h>

#include <functional>
#include <optional>
#include <string>

#include "ros/pair_watch.hpp"
#include "ros/params.hpp"

namespace flight_corridor_ros {

/// One stereo pair as received.
struct StereoMessages {
  StereoMessages() = default;
  StereoMessages(const sensor_msgs::ImageConstPtr& left, const sensor_msgs::CameraInfoConstPtr& left_info,
                 const sensor_msgs::ImageConstPtr& right, const sensor_msgs::CameraInfoConstPtr& right_info);

  sensor_msgs::ImageConstPtr left;
  sensor_msgs::CameraInfoConstPtr left_info;
  sensor_msgs::ImageConstPtr right;
  sensor_msgs::CameraInfoConstPtr right_info;
  std_msgs::Header header;  ///< The left image's, its frame without a leading slash: the header of all outputs.
};

/// Stereo pairs of left/ and right/ image_rect and camera_info, by equal or similar stamps. Survives looping bags.
class StereoSubscriber {
 public:
  StereoSubscriber(const ros::NodeHandle& node, const RosConfig& config,
                   std::function<void(const StereoMessages&)> callback);

  /// Why no pair has come for a while, and the remedy. Any thread.
  std::string explainSilence(double silent_s) const;

 private:
  using Exact = message_filters::sync_policies::ExactTime<sensor_msgs::Image, sensor_msgs::CameraInfo,
                                                          sensor_msgs::Image, sensor_msgs::CameraInfo>;
  using Approximate = message_filters::sync_policies::ApproximateTime<sensor_msgs::Image, sensor_msgs::CameraInfo,
                                                                      sensor_msgs::Image, sensor_msgs::CameraInfo>;

  template <typename Sync>
  void connect(Sync& sync);
  template <typename Message, typename Topic>
  void letThrough(PairWatch::Topic which, Topic& topic, message_filters::PassThrough<Message>& possible);
  void receive(const sensor_msgs::ImageConstPtr& left, const sensor_msgs::CameraInfoConstPtr& left_info,
               const sensor_msgs::ImageConstPtr& right, const sensor_msgs::CameraInfoConstPtr& right_info);

  std::function<void(const StereoMessages&)> callback_;
  const bool approximate_sync_;
  PairWatch watch_;
  // Messages with a possible stamp, for the synchronizer; they outlive the callbacks that pass them on.
  message_filters::PassThrough<sensor_msgs::Image> possible_left_, possible_right_;
  message_filters::PassThrough<sensor_msgs::CameraInfo> possible_left_info_, possible_right_info_;
  image_transport::ImageTransport transport_;
  image_transport::SubscriberFilter left_, right_;
  message_filters::Subscriber<sensor_msgs::CameraInfo> left_info_, right_info_;
  std::optional<message_filters::Synchronizer<Exact>> exact_;
  std::optional<message_filters::Synchronizer<Approximate>> approximate_;
};

}  // namespace flight_corridor_ros
