#include "ros/pair_watch.hpp"

#include <algorithm>

namespace flight_corridor_ros {

namespace {

constexpr char kCalibrate[] =
    "Calibrate the cameras (camera_calibration) and let their driver publish it, or give the files to "
    "raw_stereo.launch (left_calibration, right_calibration). ";

void append(std::string& list, const std::string& name) { list += (list.empty() ? "" : ", ") + name; }

}  // namespace

void PairWatch::hear(Topic topic, const sensor_msgs::Image& /*image*/, double now_s) {
  const std::lock_guard<std::mutex> lock(mutex_);
  heard_[topic] = {now_s, false};
}

/// image_proc rectifies nothing where K is 0; P is what depth is measured by.
void PairWatch::hear(Topic topic, const sensor_msgs::CameraInfo& info, double now_s) {
  const std::lock_guard<std::mutex> lock(mutex_);
  heard_[topic] = {now_s, info.K[0] == 0.0 || info.P[0] == 0.0};
}

std::string PairWatch::explain(const std::array<std::string, 4>& names, double since_s,
                               const std::string& stamps) const {
  std::string images, infos, uncalibrated;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const bool has_ended = std::all_of(heard_.begin(), heard_.end(), [&](const Heard& heard) {
      return -flight_corridor::kInfinity < heard.at_s && heard.at_s < since_s;
    });
    if (has_ended) return "All four topics came before and are silent now: has the driver, or the bag, ended?";
    for (const Topic topic : {kLeft, kLeftInfo, kRight, kRightInfo}) {
      const bool is_image = topic == kLeft || topic == kRight;
      if (heard_[topic].at_s < since_s) {
        append(is_image ? images : infos, names[topic]);
      } else if (heard_[topic].is_uncalibrated) {
        append(uncalibrated, names[topic]);
      }
    }
  }
  std::string text;
  if (!uncalibrated.empty()) text += "Not calibrated (K or P is 0): " + uncalibrated + ". ";
  if (!infos.empty()) text += "No CameraInfo on " + infos + ". ";
  if (!text.empty()) text += kCalibrate;
  if (!images.empty()) text += "No image on " + images + ". Do driver and rectification run?";
  if (!text.empty()) return text;
  return "All topics came, but their stamps do not match. Needed are " + stamps + " ones on " + names[kLeft] + ", " +
         names[kLeftInfo] + ", " + names[kRight] + ", " + names[kRightInfo] + " (ros/approximate_sync)";
}

}  // namespace flight_corridor_ros
