#include "ros/attitude_watch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ros/imu.hpp"

namespace flight_corridor_ros {

namespace {

constexpr double kWindow_s = 2.0, kSure_s = 1.0, kGap_s = 0.5, kDisbelief_s = 10.0;
constexpr double kLeastForce_mps2 = 4.9;  // half of gravity; below, in a dive, its direction says little
constexpr double kDegree = M_PI / 180.0;
constexpr double kForceLimit_rad = 60.0 * kDegree;  // a level turn banked by this, with 1.7 g aside for two seconds
constexpr double kTurnLimit_rad = 10.0 * kDegree;   // a gyro's drift, and an attitude 0.05 s late at 3 rad/s

/// Between 0 and pi; NaN if there is a NaN.
double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

std::string describe(const char* what, double angle_rad, double limit_rad) {
  char text[200];
  std::snprintf(text, sizeof text, "the imu's %s of the last %.0f s contradicts it by %.0f deg (at most %.0f deg)",
                what, kWindow_s, angle_rad / kDegree, limit_rad / kDegree);
  return text;
}

/// The turn within a time at a rate.
Eigen::Quaterniond turn(const Eigen::Vector3d& rate_rad_s, double elapsed_s) {
  const double angle_rad = rate_rad_s.norm() * elapsed_s;
  if (!(angle_rad > 0.0)) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, rate_rad_s.normalized()));
}

}  // namespace

void AttitudeWatch::add(const sensor_msgs::Imu& message, const Eigen::Vector3d& up_I) {
  const double stamp_s = message.header.stamp.toSec();
  const auto force_I = toForce(message), rate_I = toRate(message);
  const Eigen::Vector3d none = Eigen::Vector3d::Constant(NAN);
  const double elapsed_s = samples_.empty() ? kGap_s : stamp_s - samples_.back().stamp_s;
  if (std::abs(elapsed_s) >= kGap_s || message.header.frame_id != frame_) {
    samples_.clear();
    frame_ = message.header.frame_id;
  } else if (elapsed_s <= 0.0) {
    return;
  } else {
    const Eigen::Vector3d rate_rad_s = 0.5 * (samples_.back().rate_I + rate_I.value_or(none));
    R_G_I_ = (R_G_I_ * turn(rate_rad_s, elapsed_s)).normalized();
  }
  samples_.push_back({stamp_s, R_G_I_ * up_I, R_G_I_ * force_I.value_or(none), rate_I.value_or(none)});
  while (stamp_s - samples_.front().stamp_s > kWindow_s) samples_.pop_front();
}

std::optional<std::string> AttitudeWatch::contradiction() {
  if (samples_.empty()) return std::nullopt;
  const double now_s = samples_.back().stamp_s;
  const auto found = contradictionNow();
  if (found && now_s - samples_.front().stamp_s >= kSure_s) {
    last_ = *found;
    believed_s_ = now_s + kDisbelief_s;
  }
  if (found) return found;
  if (believed_s_ && now_s < *believed_s_) return last_;
  return std::nullopt;
}

std::optional<std::string> AttitudeWatch::contradictionNow() const {
  Eigen::Vector3d force_G = Eigen::Vector3d::Zero(), up_G = Eigen::Vector3d::Zero();
  std::size_t forces = 0;
  bool turns = false;
  for (const Sample& sample : samples_) {
    up_G += sample.up_G;
    turns |= sample.rate_I.norm() > 0.0;
    if (!sample.force_G.allFinite()) continue;
    force_G += sample.force_G;
    ++forces;
  }
  const double leaning_rad = angleBetween(force_G, up_G);
  if (force_G.norm() >= kLeastForce_mps2 * static_cast<double>(forces) && leaning_rad > kForceLimit_rad) {
    return describe("acceleration", leaning_rad, kForceLimit_rad);
  }
  double sum_rad = 0.0;
  for (const Sample& sample : samples_) sum_rad += angleBetween(sample.up_G, up_G);
  const double straying_rad = sum_rad / static_cast<double>(samples_.size());
  if (turns && straying_rad > kTurnLimit_rad) return describe("angular velocity", straying_rad, kTurnLimit_rad);
  return std::nullopt;
}

void AttitudeWatch::reset() { *this = AttitudeWatch(); }

}  // namespace flight_corridor_ros
