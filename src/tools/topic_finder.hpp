#pragma once

#include <rosbag/bag.h>

#include <string>

#include "tools/stereo_topics.hpp"

namespace flight_corridor::tools {

/// Whether a word of an image topic's name begins with "rect": image_rect, image_rect_color, image_rectified.
bool isNamedRectified(const std::string& topic);

/// The name of an image topic without the "/compressed" behind it, if there is one.
std::string withoutCompression(const std::string& topic);

/// Fills the topics that are empty. Those of StereoTopics where the bag has them; else images whose names differ by
/// left and right, l and r, or a number and the next one: rectified before raw, grey before colour; their camera_info
/// beside them; the only Range, Imu and Odometry. Depth images are left out: those of
/// type 16UC1 or 32FC1, and, where there are others, those that are called depth or disparity. An imu or odometry is
/// left empty where there are several, a Range that is called "none" too.
/// @param needs_info whether CameraInfos are needed.
/// @throws std::runtime_error naming the bag, the candidates if there are several, and the options to name one.
StereoTopics findTopics(const rosbag::Bag& bag, StereoTopics topics, bool needs_info);

/// A bag's topics with type, count and rate, a line each.
std::string listTopics(const rosbag::Bag& bag);

}  // namespace flight_corridor::tools
