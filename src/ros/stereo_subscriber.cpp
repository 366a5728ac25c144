#include "ros/stereo_subscriber.hpp"

#include <utility>

#include "ros/transforms.hpp"

namespace flight_corridor_ros {

StereoMessages::StereoMessages(const sensor_msgs::ImageConstPtr& left, const sensor_msgs::CameraInfoConstPtr& left_info,
                               const sensor_msgs::ImageConstPtr& right,
                               const sensor_msgs::CameraInfoConstPtr& right_info)
    : left(left), left_info(left_info), right(right), right_info(right_info), header(left->header) {
  header.frame_id = withoutSlash(header.frame_id);
}

StereoSubscriber::StereoSubscriber(const ros::NodeHandle& node, const RosConfig& config,
                                   std::function<void(const StereoMessages&)> callback)
    : callback_(std::move(callback)), approximate_sync_(config.approximate_sync), transport_(node) {
  ros::NodeHandle handle(node);
  const auto queue = static_cast<std::uint32_t>(config.sync_queue);
  // Transport plugins write parameters of their own: not into the private namespace, where every key must be known.
  const image_transport::TransportHints hints(config.image_transport, ros::TransportHints().tcpNoDelay(),
                                              ros::NodeHandle(node, "image_transport"));
  left_.subscribe(transport_, "left/image_rect", queue, hints);
  right_.subscribe(transport_, "right/image_rect", queue, hints);
  left_info_.subscribe(handle, "left/camera_info", queue);
  right_info_.subscribe(handle, "right/camera_info", queue);
  if (config.approximate_sync) {
    Approximate policy(queue);
    policy.setMaxIntervalDuration(ros::Duration(config.sync_slop_s));
    connect(approximate_.emplace(std::move(policy)));
  } else {
    connect(exact_.emplace(Exact(queue)));
  }
}

template <typename Sync>
void StereoSubscriber::connect(Sync& sync) {
  sync.setReset(true);
  sync.connectInput(possible_left_, possible_left_info_, possible_right_, possible_right_info_);
  letThrough(PairWatch::kLeft, left_, possible_left_);
  letThrough(PairWatch::kLeftInfo, left_info_, possible_left_info_);
  letThrough(PairWatch::kRight, right_, possible_right_);
  letThrough(PairWatch::kRightInfo, right_info_, possible_right_info_);
  sync.registerCallback(&StereoSubscriber::receive, this);
}

template <typename Message, typename Topic>
void StereoSubscriber::letThrough(PairWatch::Topic which, Topic& topic,
                                  message_filters::PassThrough<Message>& possible) {
  const boost::function<void(const boost::shared_ptr<const Message>&)> pass =
      [this, which, &possible](const boost::shared_ptr<const Message>& message) {
        watch_.hear(which, *message, ros::SteadyTime::now().toSec());
        if (isPossible(message->header.stamp)) possible.add(message);
      };
  topic.registerCallback(pass);
}

void StereoSubscriber::receive(const sensor_msgs::ImageConstPtr& left, const sensor_msgs::CameraInfoConstPtr& left_info,
                               const sensor_msgs::ImageConstPtr& right,
                               const sensor_msgs::CameraInfoConstPtr& right_info) {
  callback_({left, left_info, right, right_info});
}

std::string StereoSubscriber::explainSilence(double silent_s) const {
  return watch_.explain({left_.getTopic(), left_info_.getTopic(), right_.getTopic(), right_info_.getTopic()},
                        ros::SteadyTime::now().toSec() - silent_s, approximate_sync_ ? "similar" : "equal");
}

}  // namespace flight_corridor_ros
