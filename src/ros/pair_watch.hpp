#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <array>
#include <mutex>
#include <string>

#include "flight_corridor/types.hpp"

namespace flight_corridor_ros {

/// Records when the four topics of a stereo pair were heard, to explain missing pairs. Any thread.
class PairWatch {
 public:
  enum Topic { kLeft, kLeftInfo, kRight, kRightInfo };

  /// @param now_s by a steady clock.
  void hear(Topic topic, const sensor_msgs::Image& image, double now_s);
  void hear(Topic topic, const sensor_msgs::CameraInfo& info, double now_s);

  /// The topics missing since a moment, and the remedy.
  /// @param names of the topics, in the order of Topic.   @param stamps "equal" or "similar".
  std::string explain(const std::array<std::string, 4>& names, double since_s, const std::string& stamps) const;

 private:
  struct Heard {
    double at_s = -flight_corridor::kInfinity;
    bool is_uncalibrated = false;
  };

  mutable std::mutex mutex_;
  std::array<Heard, 4> heard_;
};

}  // namespace flight_corridor_ros
