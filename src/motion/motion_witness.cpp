#include "flight_corridor/motion/motion_witness.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace flight_corridor {

namespace {

constexpr double kLeast_m = 0.3, kLeast_rad = 5.0 * M_PI / 180.0;  // of a way that is compared
constexpr double kSignificantSigmas = 3.0;                         // of the difference
// What is told is odometry, or a filter's pose: 2 % and 1 cm, and a rotation that drifts by half a degree a second.
constexpr double kToldShare = 0.02, kTold_m = 0.01, kTold_radps = 0.5 * M_PI / 180.0;

Eigen::Vector3d rotationVector(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

double degrees(double rad) { return rad * 180.0 / M_PI; }

}  // namespace

std::string describe(const Way& way) {
  const double told_m = way.told_m.norm(), seen_m = way.seen_m.norm();
  std::ostringstream text;
  text.setf(std::ios::fixed);
  text.precision(2);
  const auto motion = [&](const Eigen::Vector3d& moved_m, const Eigen::Vector3d& turned_rad) {
    text << "(" << moved_m.x() << ", " << moved_m.y() << ", " << moved_m.z() << ") m, turned by ("
         << degrees(turned_rad.x()) << ", " << degrees(turned_rad.y()) << ", " << degrees(turned_rad.z()) << ") deg";
  };
  text << "within " << way.duration_s << " s the camera moved by ";
  motion(way.told_m, way.told_rad);
  text << " as told, by ";
  motion(way.seen_m, way.seen_rad);
  text << " as its images show (x right, y down, z ahead)";
  if (told_m < kLeast_m || seen_m < kLeast_m) return text.str();
  const double between_rad = std::acos(std::clamp(way.told_m.dot(way.seen_m) / (told_m * seen_m), -1.0, 1.0));
  text.precision(1);
  text << ": directions " << degrees(between_rad) << " deg apart (principal point, a cropped image, or the camera's "
       << "mounting in tf), seen " << std::lround(100.0 * (seen_m / told_m - 1.0))
       << " % longer (baseline or focal length)";
  return text.str();
}

bool MotionWitness::isComparable(const Eigen::Isometry3d& T_S_C) {
  return T_S_C.translation().norm() >= kLeast_m || Eigen::AngleAxisd(T_S_C.linear()).angle() >= kLeast_rad;
}

bool MotionWitness::disagrees(double duration_s, const Eigen::Isometry3d& told_S_C, const RelativePose& seen) {
  const double length_m = std::max(told_S_C.translation().norm(), seen.T_K_C.translation().norm());
  const double turn_rad =
      std::max(rotationVector(told_S_C.linear()).norm(), rotationVector(seen.T_K_C.linear()).norm());
  const double drift_rad = kTold_radps * duration_s;
  const double sigma_m = std::hypot(seen.sigma_m, kToldShare * length_m + kTold_m, drift_rad * length_m);
  const double sigma_rad = std::hypot(seen.sigma_rad, kToldShare * turn_rad, drift_rad);
  const double off_rad = rotationVector(told_S_C.linear().transpose() * seen.T_K_C.linear()).norm();
  const double off_m = (seen.T_K_C.translation() - told_S_C.translation()).norm();
  return off_m > kSignificantSigmas * sigma_m || off_rad > kSignificantSigmas * sigma_rad;
}

void MotionWitness::add(double duration_s, const Eigen::Isometry3d& told_S_C, const RelativePose& seen) {
  if (!isComparable(told_S_C) && !isComparable(seen.T_K_C)) return;
  if (!disagrees(duration_s, told_S_C, seen)) {
    disagreeing_ = 0;
    return;
  }
  ++disagreeing_;
  way_ = {duration_s, told_S_C.translation(), seen.T_K_C.translation(), rotationVector(told_S_C.linear()),
          rotationVector(seen.T_K_C.linear())};
}

}  // namespace flight_corridor
