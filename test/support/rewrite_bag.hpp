#pragma once

#include <cv_bridge/cv_bridge.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <filesystem>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <string>

namespace flight_corridor::test_support {

inline void copyMessage(const rosbag::MessageInstance& message, rosbag::Bag& out) {
  out.write(message.getTopic(), message.getTime(), message, message.getConnectionHeader());
}

/// Replaces a bag by what `write` makes of its messages.
inline void rewriteBag(const std::string& path,
                       const std::function<void(const rosbag::MessageInstance& message, rosbag::Bag& out)>& write) {
  {
    rosbag::Bag in(path, rosbag::bagmode::Read), out(path + ".new", rosbag::bagmode::Write);
    for (const rosbag::MessageInstance& message : rosbag::View(in)) write(message, out);
  }
  std::filesystem::rename(path + ".new", path);
}

/// As image_transport compresses.
/// @param extension ".png" or ".jpg".
inline sensor_msgs::CompressedImage compress(const sensor_msgs::ImageConstPtr& image, const std::string& extension) {
  sensor_msgs::CompressedImage compressed;
  compressed.header = image->header;
  compressed.format = image->encoding + (extension == ".png" ? "; png compressed " : "; jpeg compressed ");
  cv::imencode(extension, cv_bridge::toCvShare(image)->image, compressed.data);
  return compressed;
}

/// Replaces an image topic by its compressed one.
inline void compressTopic(const std::string& path, const std::string& topic, const std::string& extension,
                          const std::string& compressed_topic) {
  rewriteBag(path, [&](const rosbag::MessageInstance& message, rosbag::Bag& out) {
    if (message.getTopic() != topic) return copyMessage(message, out);
    out.write(compressed_topic, message.getTime(), compress(message.instantiate<sensor_msgs::Image>(), extension));
  });
}

}  // namespace flight_corridor::test_support
