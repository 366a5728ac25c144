#pragma once

#include <gtest/gtest.h>
#include <tf2_eigen/tf2_eigen.h>

#include <cmath>
#include <string>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "ros/processor.hpp"
#include "support/stereo_inputs.hpp"

namespace flight_corridor_ros::test_support {

inline const ros::Time kStart(100, 0);
inline constexpr double kNear_m = 3.0, kFar_m = 7.0;

/// A camera with a LiDAR in its place, and nobody's messages but those that a test gives.
class ProcessorTest : public testing::Test {
 protected:
  ProcessorTest() { mount("range_link", 0.0); }

  /// Turned to the left against the beam, at a stamp, or for ever.
  void mount(const std::string& frame, double left_rad, const ros::Time& stamp = ros::Time()) {
    const Eigen::AngleAxisd left(-left_rad, Eigen::Vector3d::UnitY());
    geometry_msgs::TransformStamped mounted =
        tf2::eigenToTransform(Eigen::Isometry3d(left) * flight_corridor::opticalFromForward());
    mounted.header.frame_id = "left_optical";
    mounted.header.stamp = stamp;
    mounted.child_frame_id = frame;
    transforms.add(mounted, stamp.isZero());
  }

  static StereoMessages messages(const StereoInputs& inputs) {
    return {inputs.left, boost::make_shared<sensor_msgs::CameraInfo>(inputs.left_info), inputs.right,
            boost::make_shared<sensor_msgs::CameraInfo>(inputs.right_info)};
  }

  /// The verdict on a wall that stereo sees; equal seeds show equal images.
  flight_corridor::Verdict see(double wall_m, const ros::Time& stamp, std::uint64_t seed) {
    StereoInputs inputs(wall_m, seed);
    inputs.stamp(stamp);
    inputs.left_info.P[2] += principal_point_px;
    inputs.right_info.P[2] += principal_point_px;
    return processor.process(messages(inputs)).verdict;
  }

  void putRange(const std::string& frame, double range_m, const ros::Time& stamp) {
    sensor_msgs::Range range = StereoInputs(kFar_m).range;
    range.header.stamp = stamp;
    range.header.frame_id = frame;
    range.range = static_cast<float>(range_m);
    inbox.put(boost::make_shared<const sensor_msgs::Range>(range));
  }

  Transforms transforms;
  NodeConfig config;
  Inbox inbox;
  Processor processor{config, transforms, inbox};
  double principal_point_px = 0.0;
};

}  // namespace flight_corridor_ros::test_support
