#include "tools/pair_rectifier.hpp"

#include <cv_bridge/cv_bridge.h>
#include <ros/console.h>
#include <sensor_msgs/image_encodings.h>

#include <stdexcept>

#include "ros/conversions.hpp"
#include "tools/topic_finder.hpp"

namespace flight_corridor::tools {
namespace {

namespace encodings = sensor_msgs::image_encodings;
using sensor_msgs::CameraInfo;

bool haveSameCalibration(const CameraInfo& a, const CameraInfo& b) {
  return a.width == b.width && a.height == b.height && a.distortion_model == b.distortion_model && a.D == b.D &&
         a.K == b.K && a.R == b.R && a.P == b.P;
}

/// As a matrix of 8 bits: a mosaic of colours cannot be interpolated.
cv_bridge::CvImageConstPtr toPicture(const sensor_msgs::ImageConstPtr& message,
                                     flight_corridor_ros::EightOfSixteen bits) {
  const std::string& encoding = message->encoding;
  const bool has_colour = encodings::isColor(encoding) || encodings::isBayer(encoding);
  if (has_colour && encodings::bitDepth(encoding) == 8) return cv_bridge::toCvShare(message, encodings::BGR8);
  return flight_corridor_ros::toGrey(message, bits);
}

sensor_msgs::ImagePtr toMessage(const std_msgs::Header& header, const cv::Mat& image) {
  return flight_corridor_ros::toImage(header, image, image.channels() == 1 ? encodings::MONO8 : encodings::BGR8);
}

}  // namespace

bool areRaw(ImageState declared, const std::string& topic, const StereoCameras& cameras) {
  if (declared != ImageState::AsNamed) return declared == ImageState::Raw;
  return !isNamedRectified(topic) && !areRectified(cameras);
}

void PairRectifier::fit(const StereoCameras& cameras) {
  const bool is_known = rectifier_ && haveSameCalibration(cameras_.left, cameras.left) &&
                        haveSameCalibration(cameras_.right, cameras.right);
  if (is_known) return;
  rectifier_.emplace(cameras);
  cameras_ = cameras;
}

flight_corridor_ros::StereoMessages PairRectifier::rectify(const flight_corridor_ros::StereoMessages& raw) {
  const StereoCameras cameras{*raw.left_info, *raw.right_info}, ideal = rectified(cameras);
  const auto left_info = boost::make_shared<CameraInfo>(ideal.left);
  const auto right_info = boost::make_shared<CameraInfo>(ideal.right);
  cv::Mat left, right;
  try {
    const auto bits = flight_corridor_ros::bitsOf(*raw.left, *raw.right);
    const cv_bridge::CvImageConstPtr raw_left = toPicture(raw.left, bits), raw_right = toPicture(raw.right, bits);
    const auto fits = [](const cv::Mat& image, const CameraInfo& info) {
      return image.cols == static_cast<int>(info.width) && image.rows == static_cast<int>(info.height);
    };
    if (!fits(raw_left->image, *left_info) || !fits(raw_right->image, *right_info)) {
      throw std::invalid_argument("an image has another size than its CameraInfo");
    }
    fit(cameras);
    left = rectifier_->left(raw_left->image);
    right = rectifier_->right(raw_right->image);
  } catch (const std::exception& error) {
    left.release();  // both, or neither
    if (warning_.due()) {
      ROS_WARN("the raw pair of %.3f cannot be rectified and is UNKNOWN: %s", raw.header.stamp.toSec(), error.what());
    }
  }
  return {toMessage(raw.left->header, left), left_info, toMessage(raw.right->header, right), right_info};
}

}  // namespace flight_corridor::tools
