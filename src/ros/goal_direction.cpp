#include "ros/goal_direction.hpp"

#include <ros/console.h>

#include <cmath>

#include "flight_corridor/range/pending_readings.hpp"
#include "ros/stamp_age.hpp"

namespace flight_corridor_ros {

void GoalDirection::put(const geometry_msgs::Vector3Stamped& message, const ros::Time& now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const Eigen::Vector3d direction(message.vector.x, message.vector.y, message.vector.z);
  const std::string frame = withoutSlash(message.header.frame_id);
  const double largest = direction.cwiseAbs().maxCoeff(), age_s = now.toSec() - message.header.stamp.toSec();
  if (frame.empty()) return refuse("it names no frame (header.frame_id)");
  if (!direction.allFinite() || largest == 0.0) {
    return refuse("its vector has no direction: it is zero, or a number of it is NaN or infinite");
  }
  if (!message.header.stamp.isZero() && !(std::abs(age_s) <= flight_corridor::kLongestDelay_s)) {
    return refuse("it is " + describeAge(age_s) + ", outside +-" + std::to_string(flight_corridor::kLongestDelay_s) +
                  " s: stamp it when it is sent, or with 0");
  }
  frame_ = frame;
  direction_ = (direction / largest).normalized();  // the square of a large or small number is none
}

void GoalDirection::refuse(const std::string& why) {
  if (warning_.due()) ROS_WARN("a goal_direction is refused, the last one is kept: %s", why.c_str());
}

std::optional<Eigen::Vector3d> GoalDirection::find(const std_msgs::Header& camera) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (frame_.empty()) return std::nullopt;
  const auto T_C_G = transforms_.find(camera.frame_id, frame_, camera.stamp, 0.0, flight_corridor::kLongestDelay_s);
  if (T_C_G) return T_C_G->linear() * direction_;
  if (frame_warning_.due()) {
    ROS_WARN(
        "tf does not connect \"%s\" (goal_direction) with the camera's frame \"%s\" within %.1f s of the image: "
        "straight ahead is wanted instead. Publish it, or name a frame that tf has",
        frame_.c_str(), camera.frame_id.c_str(), flight_corridor::kLongestDelay_s);
  }
  return std::nullopt;
}

}  // namespace flight_corridor_ros
