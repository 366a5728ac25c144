#pragma once

#include <optional>
#include <string>

#include "ros/heartbeat.hpp"
#include "ros/stereo_subscriber.hpp"
#include "tools/rectifier.hpp"

namespace flight_corridor::tools {

/// Whether images are raw or rectified.
enum class ImageState { AsNamed, Raw, Rectified };

/// Whether a pair's images are to be rectified. Unless declared, they are raw where their cameras differ from rectified
/// ones and no part of the topic's name begins with "rect" (image_rect, image_rect_color, image_rectified).
bool areRaw(ImageState declared, const std::string& topic, const StereoCameras& cameras);

/// Rectifies raw pairs as messages, following changes of their calibration.
class PairRectifier {
 public:
  /// Images become mono8, or bgr8 where they have colour of 8 bit. If an image cannot be rectified, the result is
  /// empty, and a warning says why.
  flight_corridor_ros::StereoMessages rectify(const flight_corridor_ros::StereoMessages& raw);

 private:
  void fit(const StereoCameras& cameras);

  StereoCameras cameras_;
  std::optional<Rectifier> rectifier_;
  flight_corridor_ros::Throttle warning_;
};

}  // namespace flight_corridor::tools
