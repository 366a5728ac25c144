#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Range.h>

#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <string>

#include "ros/conversions.hpp"

namespace flight_corridor_ros::test_support {

/// A textured wall across the view, as one stereo pair with its CameraInfos and a LiDAR reading.
struct StereoInputs {
  static constexpr double kFocal_px = 350.0, kBaseline_m = 0.12;

  sensor_msgs::ImagePtr left, right;
  sensor_msgs::CameraInfo left_info, right_info;
  sensor_msgs::Range range;
  std::string frame_prefix;  ///< "/" as in tf's first generation.

  /// @param wall_m at a whole number of pixels of disparity: a divisor of f*B = 42 px*m.
  /// @param seed of the texture: no two images of a camera are equal.
  explicit StereoInputs(double wall_m, std::uint64_t seed = 1) {
    const int disparity_px = static_cast<int>(std::lround(kFocal_px * kBaseline_m / wall_m));
    cv::Mat texture(480, 640 + disparity_px, CV_8UC1);
    cv::RNG random(seed);
    random.fill(texture, cv::RNG::UNIFORM, 0, 255);
    cv::GaussianBlur(texture, texture, {0, 0}, 1.5);
    const cv::Rect left_view(0, 0, 640, 480), right_view(disparity_px, 0, 640, 480);
    left = toImage({}, texture(left_view), "mono8");
    right = toImage({}, texture(right_view), "mono8");
    left_info = cameraInfo(0.0);
    right_info = cameraInfo(-kFocal_px * kBaseline_m);
    range.field_of_view = 0.03f;
    range.min_range = 0.2f;
    range.max_range = 100.0f;
    range.range = static_cast<float>(wall_m);
  }

  void stamp(const ros::Time& time) {
    left->header.stamp = right->header.stamp = left_info.header.stamp = right_info.header.stamp = time;
    left->header.frame_id = right->header.frame_id = frame_prefix + "left_optical";
    left_info.header = left->header;
    right_info.header = right->header;
    range.header.stamp = time;
    range.header.frame_id = frame_prefix + "range_link";
  }

 private:
  static sensor_msgs::CameraInfo cameraInfo(double p3) {
    sensor_msgs::CameraInfo info;
    info.width = 640;
    info.height = 480;
    info.P = {kFocal_px, 0, 319.5, p3, 0, kFocal_px, 239.5, 0, 0, 0, 1, 0};
    return info;
  }
};

/// The topics that the launch file expects of a rig.
class RigTopics {
 public:
  void send(const StereoInputs& inputs) {
    range_.publish(inputs.range);
    left_info_.publish(inputs.left_info);
    right_info_.publish(inputs.right_info);
    left_.publish(inputs.left);
    right_.publish(inputs.right);
  }

  /// Whether so many nodes hear the stereo topics.
  bool isHeardBy(std::uint32_t nodes) const {
    return left_.getNumSubscribers() >= nodes && right_.getNumSubscribers() >= nodes &&
           left_info_.getNumSubscribers() >= nodes && right_info_.getNumSubscribers() >= nodes;
  }

 private:
  ros::NodeHandle node_;
  ros::Publisher left_ = node_.advertise<sensor_msgs::Image>("/stereo/left/image_rect", 5);
  ros::Publisher right_ = node_.advertise<sensor_msgs::Image>("/stereo/right/image_rect", 5);
  ros::Publisher left_info_ = node_.advertise<sensor_msgs::CameraInfo>("/stereo/left/camera_info", 5);
  ros::Publisher right_info_ = node_.advertise<sensor_msgs::CameraInfo>("/stereo/right/camera_info", 5);
  ros::Publisher range_ = node_.advertise<sensor_msgs::Range>("/range", 5);
};

}  // namespace flight_corridor_ros::test_support
