#include "ros/transforms.hpp"

namespace flight_corridor_ros {

std::string withoutSlash(const std::string& frame) {
  const std::size_t first = frame.find_first_not_of('/');
  return first == std::string::npos ? "" : frame.substr(first);
}

std::optional<Eigen::Isometry3d> Transforms::find(std::string target, std::string source, const ros::Time& stamp,
                                                  double timeout_s) const {
  target = withoutSlash(target);
  source = withoutSlash(source);
  if (target.empty() || source.empty()) return std::nullopt;
  if (target == source) return Eigen::Isometry3d::Identity();  // also where tf has never heard of it
  const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(timeout_s);
  const ros::WallDuration pause(0.001);
  while (!buffer_.canTransform(target, source, stamp) && ros::WallTime::now() < deadline) pause.sleep();
  try {
    const geometry_msgs::Transform pose = buffer_.lookupTransform(target, source, stamp).transform;
    const Eigen::Translation3d position(pose.translation.x, pose.translation.y, pose.translation.z);
    const auto& q = pose.rotation;
    return position *
           Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized();  // tf takes squared norms that are off by 1 %
  } catch (const tf2::TransformException&) {
    return std::nullopt;
  }
}

}  // namespace flight_corridor_ros
