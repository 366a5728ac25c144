#include <nodelet/nodelet.h>
#include <sensor_msgs/Image.h>

#include <exception>
#include <pluginlib/class_list_macros.hpp>

#include "ros/camera_info_file.hpp"
#include "ros/heartbeat.hpp"

namespace flight_corridor_ros {

/// camera_info for each image_raw, from the calibration file ~file: for cameras whose driver publishes none.
class CameraInfoNodelet : public nodelet::Nodelet {
 private:
  void onInit() override try {
    ros::NodeHandle node = getNodeHandle();
    path_ = getPrivateNodeHandle().param<std::string>("file", "");
    info_ = readCameraInfo(path_);
    publisher_ = node.advertise<sensor_msgs::CameraInfo>("camera_info", kQueue);
    images_ = node.subscribe("image_raw", kQueue, &CameraInfoNodelet::receive, this);
  } catch (const std::exception& error) {
    NODELET_FATAL("calibration file (~file): %s", error.what());
    throw;  // the manager refuses the nodelet and lives on
  }

  void receive(const sensor_msgs::ImageConstPtr& image) {
    if (image->width == info_.width && image->height == info_.height) {
      info_.header = image->header;
      publisher_.publish(info_);
    } else if (size_warning_.due()) {
      NODELET_ERROR("no CameraInfo: images of %s are %ux%u px, %s is for %ux%u", images_.getTopic().c_str(),
                    image->width, image->height, path_.c_str(), info_.width, info_.height);
    }
  }

  static constexpr std::uint32_t kQueue = 10;
  std::string path_;
  sensor_msgs::CameraInfo info_;
  ros::Publisher publisher_;
  ros::Subscriber images_;
  Throttle size_warning_;
};

}  // namespace flight_corridor_ros

PLUGINLIB_EXPORT_CLASS(flight_corridor_ros::CameraInfoNodelet, nodelet::Nodelet)
