#pragma once

#include <flight_corridor/CorridorState.h>
#include <flight_corridor/QueryCorridor.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>
#include <octomap_msgs/GetOctomap.h>
#include <ros/ros.h>
#include <tf2_eigen/tf2_eigen.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <memory>
#include <optional>
#include <sstream>
#include <string>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "support/stereo_inputs.hpp"

namespace flight_corridor_ros::test_support {

using flight_corridor::CorridorState;
using flight_corridor::QueryCorridor;
using flight_corridor::QueryCorridorResponse;
using octomap_msgs::Octomap;

inline constexpr double kFarWall_m = 6.0, kNearWall_m = 2.0;
inline constexpr std::uint32_t kNodes = 2;                          // in the launch file
inline constexpr double kPatience_s = 30.0, kPairPatience_s = 5.0;  // a loaded machine may need seconds for an answer
inline constexpr double kWatchdog_s = 3.0;                          // ros/watchdog_s in the launch file
// The part of the corridor that the cameras see whole.
inline constexpr double kStart_m = 1.0, kLength_m = 3.0, kWidth_m = 1.2, kHeight_m = 0.4;

inline Eigen::Isometry3d ahead_C(double start_m = kStart_m) {
  return flight_corridor::opticalFromForward() * Eigen::Translation3d(start_m, 0.0, 0.0);
}

/// Sends pairs, one after the other is answered, and asks the node in between.
class Asker : public testing::Test {
 protected:
  explicit Asker(const std::string& name = "/flight_corridor") : name_(name) {
    verdicts_ = node_.subscribe<CorridorState>(name + "/corridor", 10,
                                               [this](const CorridorState::ConstPtr& message) { verdict_ = *message; });
    waitFor([this] { return rig().isHeardBy(kNodes) && verdicts_.getNumPublishers() > 0; }, kPatience_s);
  }

  /// Shows a wall until the node says the state of it; the last pair that was sent is then the last one answered.
  ::testing::AssertionResult shows(double wall_m, std::uint8_t state) {
    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kPatience_s);
    while (ros::ok() && ros::WallTime::now() < deadline) {
      if (answersPair(wall_m) && verdict_->state == state) return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure() << "the last verdict was " << (verdict_ ? +verdict_->state : -1);
  }

  /// Whether one pair is answered.
  bool answersPair(double wall_m) {
    static std::uint64_t seed = 0;
    StereoInputs inputs(wall_m, ++seed);
    inputs.stamp(ros::Time::now());
    rig().send(inputs);
    return waitFor([&] { return verdict_ && verdict_->header.stamp == inputs.left->header.stamp; }, kPairPatience_s);
  }

  template <typename Condition>
  static bool waitFor(const Condition& holds, double patience_s) {
    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(patience_s);
    while (!holds() && ros::WallTime::now() < deadline) {
      ros::WallDuration(0.005).sleep();
      ros::spinOnce();
    }
    return holds();
  }

  template <typename Service>
  bool call(const std::string& service, Service& question) {
    EXPECT_TRUE(ros::service::waitForService(name_ + "/" + service, ros::Duration(kPatience_s)));
    return ros::service::call(name_ + "/" + service, question);
  }

  static QueryCorridor boxFrom(const std::string& frame, const Eigen::Isometry3d& pose) {
    QueryCorridor question;
    question.request.pose.header.frame_id = frame;
    question.request.pose.pose = tf2::toMsg(pose);
    question.request.length = kLength_m;
    question.request.width = kWidth_m;
    question.request.height = kHeight_m;
    return question;
  }

  QueryCorridorResponse ask(QueryCorridor question) {
    EXPECT_TRUE(call("query_corridor", question));
    return question.response;
  }
  QueryCorridorResponse askAhead() { return ask(boxFrom("left_optical", ahead_C())); }

  Octomap octomap(const std::string& service) {
    octomap_msgs::GetOctomap question;
    EXPECT_TRUE(call(service, question));
    return question.response.map;
  }

  /// As octomap_msgs reads its messages.
  static std::unique_ptr<octomap::OcTree> read(const Octomap& message) {
    std::unique_ptr<octomap::OcTree> tree(
        dynamic_cast<octomap::OcTree*>(octomap::AbstractOcTree::createTree(message.id, message.resolution)));
    std::stringstream data(std::string(message.data.begin(), message.data.end()));
    if (tree && !message.data.empty()) message.binary ? tree->readBinaryData(data) : tree->readData(data);
    return tree;
  }

  ros::NodeHandle node_;
  std::optional<CorridorState> verdict_;

 private:
  /// One for all cases: connecting takes longer than asking.
  static RigTopics& rig() {
    static RigTopics rig;
    return rig;
  }

  std::string name_;
  ros::Subscriber verdicts_;
};

/// With a map in a fixed frame.
class MappingAsker : public Asker {
 protected:
  MappingAsker() : Asker("/mapping") {
    geometry_msgs::TransformStamped transform = tf2::eigenToTransform(T_W_C());
    transform.header.frame_id = "odom";
    transform.child_frame_id = "left_optical";
    static tf2_ros::StaticTransformBroadcaster broadcaster;
    broadcaster.sendTransform(transform);
  }

  /// 1.5 m above the origin, looking along y.
  static Eigen::Isometry3d T_W_C() {
    return Eigen::Translation3d(0.0, 0.0, 1.5) * Eigen::AngleAxisd(M_PI_2, Eigen::Vector3d::UnitZ()) *
           ahead_C().inverse();
  }
};

}  // namespace flight_corridor_ros::test_support
