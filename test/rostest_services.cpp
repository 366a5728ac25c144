#include <flight_corridor/CorridorState.h>
#include <flight_corridor/QueryCorridor.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>
#include <octomap_msgs/BoundingBoxQuery.h>
#include <octomap_msgs/GetOctomap.h>
#include <ros/ros.h>
#include <std_srvs/Empty.h>
#include <tf2_eigen/tf2_eigen.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <cmath>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "flight_corridor/stereo_geometry.hpp"
#include "support/stereo_inputs.hpp"

namespace {

using flight_corridor::CorridorState;
using flight_corridor::QueryCorridor;
using flight_corridor::QueryCorridorResponse;
using flight_corridor_ros::test_support::RigTopics;
using flight_corridor_ros::test_support::StereoInputs;
using octomap_msgs::Octomap;

constexpr double kFarWall_m = 6.0, kNearWall_m = 2.0;
constexpr std::uint32_t kNodes = 2;                          // in the launch file
constexpr double kPatience_s = 30.0, kPairPatience_s = 5.0;  // a loaded machine may need seconds for an answer
constexpr double kWatchdog_s = 3.0;                          // ros/watchdog_s in the launch file
// The part of the corridor that the cameras see whole.
constexpr double kStart_m = 1.0, kLength_m = 3.0, kWidth_m = 1.2, kHeight_m = 0.4;

Eigen::Isometry3d ahead_C(double start_m = kStart_m) {
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

// The cases run in this order: the first one meets a node that has seen nothing.

TEST_F(Asker, BeforeThereIsAPairNothingIsKnown) {
  const QueryCorridorResponse answer = askAhead();
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_EQ(answer.state, QueryCorridorResponse::UNKNOWN);
  EXPECT_EQ(answer.reasons, CorridorState::NO_DATA);
  EXPECT_TRUE(answer.stamp.isZero());
  EXPECT_TRUE(octomap("octomap_full").data.empty());
  QueryCorridor flat = boxFrom("left_optical", ahead_C());
  flat.request.height = 0.0;
  EXPECT_FALSE(ask(flat).success) << "no box, with a map or without";
  QueryCorridor unturned = boxFrom("left_optical", ahead_C());
  unturned.request.pose.pose.orientation = geometry_msgs::Quaternion();
  EXPECT_FALSE(ask(unturned).success) << "no pose, with a map or without";
  std_srvs::Empty reset;
  EXPECT_TRUE(call("reset", reset));
}

TEST_F(Asker, ABoxAheadIsAnsweredAsTheVerdictOfItsPair) {
  for (const auto& [wall_m, state] :
       {std::pair{kFarWall_m, CorridorState::FREE}, std::pair{kNearWall_m, CorridorState::BLOCKED}}) {
    ASSERT_TRUE(shows(wall_m, state));
    const QueryCorridorResponse answer = askAhead();
    EXPECT_TRUE(answer.success) << answer.message;
    EXPECT_EQ(answer.stamp, verdict_->header.stamp);
    EXPECT_EQ(answer.state, state);
    if (state == CorridorState::FREE) {
      EXPECT_LE(answer.unknown_fraction, 0.1);
      EXPECT_EQ(answer.clear_distance, INFINITY);
    } else {  // the verdict also knows where the beam ends, within a cell of where the map does
      EXPECT_NEAR(kStart_m + answer.clear_distance, verdict_->clear_distance, 0.1);
    }
  }
}

TEST_F(Asker, AShorterBoxEndsBeforeTheWall) {
  ASSERT_TRUE(shows(kNearWall_m, CorridorState::BLOCKED));
  QueryCorridor question = boxFrom("left_optical", ahead_C(1.0));
  question.request.length = 0.6;
  EXPECT_EQ(ask(question).state, QueryCorridorResponse::FREE);
  question.request.length = 1.5;
  const QueryCorridorResponse answer = ask(question);
  EXPECT_EQ(answer.state, QueryCorridorResponse::BLOCKED);
  EXPECT_NEAR(answer.clear_distance, kNearWall_m - 1.0, 0.25);
  question.request.pose.pose = tf2::toMsg(ahead_C(1.5));
  EXPECT_NEAR(ask(question).clear_distance, kNearWall_m - 1.5, 0.25);
}

TEST_F(Asker, BadQuestionsAreRefusedByName) {
  ASSERT_TRUE(shows(kFarWall_m, CorridorState::FREE));
  QueryCorridor nowhere = boxFrom("nowhere", ahead_C()), flat = boxFrom("left_optical", ahead_C()), unturned = flat,
                lost = flat;
  flat.request.height = 0.0;
  unturned.request.pose.pose.orientation.w = unturned.request.pose.pose.orientation.x =
      unturned.request.pose.pose.orientation.y = unturned.request.pose.pose.orientation.z = 0.0;
  lost.request.pose.pose.position.x = std::nan("");
  for (const auto& [question, word] : {std::pair{nowhere, "\"nowhere\""}, std::pair{flat, "box"},
                                       std::pair{unturned, "quaternion"}, std::pair{lost, "position"}}) {
    const QueryCorridorResponse answer = ask(question);
    EXPECT_FALSE(answer.success) << word;
    EXPECT_EQ(answer.state, QueryCorridorResponse::UNKNOWN) << word;
    EXPECT_NE(answer.message.find(word), std::string::npos) << answer.message;
  }
}

TEST_F(Asker, AfterAResetNothingIsKnownUntilTheNextPair) {
  ASSERT_TRUE(shows(kFarWall_m, CorridorState::FREE));
  std_srvs::Empty reset;
  ASSERT_TRUE(call("reset", reset));
  EXPECT_EQ(askAhead().state, QueryCorridorResponse::UNKNOWN);
  EXPECT_EQ(askAhead().reasons, CorridorState::NO_DATA);
  EXPECT_TRUE(octomap("octomap_binary").data.empty());
  ASSERT_TRUE(shows(kFarWall_m, CorridorState::FREE));
  EXPECT_EQ(askAhead().state, QueryCorridorResponse::FREE);
}

TEST_F(Asker, AClearedBoxIsUnknownNotFree) {
  ASSERT_TRUE(shows(kFarWall_m, CorridorState::FREE));
  octomap_msgs::BoundingBoxQuery clear;
  clear.request.min.x = clear.request.min.y = -2.0;
  clear.request.max.x = clear.request.max.y = 2.0;
  clear.request.min.z = 1.0;
  clear.request.max.z = 3.0;
  ASSERT_TRUE(call("clear_bbx", clear));
  const auto tree = read(octomap("octomap_full"));
  EXPECT_EQ(tree->search(0.05, 0.05, 2.05), nullptr);
  EXPECT_NE(tree->search(0.05, 0.05, 4.05), nullptr);
  const QueryCorridorResponse answer = askAhead();
  EXPECT_EQ(answer.state, QueryCorridorResponse::UNKNOWN);
  EXPECT_EQ(answer.reasons, CorridorState::UNOBSERVED);
  clear.request.max.z = 0.0;
  EXPECT_FALSE(call("clear_bbx", clear));
}

TEST_F(Asker, TheOctomapsAreThoseOfTheTopics) {
  std::optional<Octomap> full, binary;
  const auto full_topic = node_.subscribe<Octomap>("/flight_corridor/octomap_full", 1,
                                                   [&](const Octomap::ConstPtr& message) { full = *message; });
  const auto binary_topic = node_.subscribe<Octomap>("/flight_corridor/octomap_binary", 1,
                                                     [&](const Octomap::ConstPtr& message) { binary = *message; });
  ASSERT_TRUE(waitFor([&] { return full_topic.getNumPublishers() > 0 && binary_topic.getNumPublishers() > 0; }, 10.0));
  const auto topics_speak = [&] {
    const auto is_current = [&](const auto& map) { return map && map->header.stamp == verdict_->header.stamp; };
    return answersPair(kNearWall_m) && waitFor([&] { return is_current(full) && is_current(binary); }, kPairPatience_s);
  };
  ASSERT_TRUE(waitFor(topics_speak, kPatience_s));

  for (const auto& [service, topic] : {std::pair{"octomap_full", *full}, std::pair{"octomap_binary", *binary}}) {
    const Octomap answer = octomap(service);
    EXPECT_EQ(answer.header.stamp, topic.header.stamp) << service;
    EXPECT_EQ(answer.header.frame_id, "left_optical") << service;
    EXPECT_EQ(answer.binary, topic.binary) << service;
    EXPECT_TRUE(answer.data == topic.data) << service;
  }
  const auto full_tree = read(*full), binary_tree = read(*binary);
  ASSERT_TRUE(full_tree && binary_tree);
  EXPECT_GT(full_tree->getNumLeafNodes(), 100u);
  EXPECT_EQ(full_tree->getNumLeafNodes(), binary_tree->getNumLeafNodes());
  for (auto leaf = full_tree->begin_leafs(); leaf != full_tree->end_leafs(); ++leaf) {
    const octomap::OcTreeNode* other = binary_tree->search(leaf.getKey(), leaf.getDepth());
    ASSERT_TRUE(other);
    ASSERT_EQ(full_tree->isNodeOccupied(*leaf), binary_tree->isNodeOccupied(other));
  }
}

TEST_F(Asker, WhenPairsStopAnswersComeButKnowNothing) {
  ASSERT_TRUE(shows(kFarWall_m, CorridorState::FREE));
  ros::WallDuration(kWatchdog_s + 1.0).sleep();
  const QueryCorridorResponse answer = askAhead();
  EXPECT_EQ(answer.state, QueryCorridorResponse::UNKNOWN);
  EXPECT_EQ(answer.reasons, CorridorState::NO_DATA);
}

TEST_F(MappingAsker, APoseInAnyFrameMeansTheSameBox) {
  ASSERT_TRUE(shows(kNearWall_m, CorridorState::BLOCKED));
  const QueryCorridorResponse from_camera = askAhead();
  const QueryCorridorResponse from_odom = ask(boxFrom("odom", T_W_C() * ahead_C()));
  for (const auto& answer : {from_camera, from_odom}) {
    EXPECT_TRUE(answer.success) << answer.message;
    EXPECT_EQ(answer.state, QueryCorridorResponse::BLOCKED);
    EXPECT_NEAR(answer.clear_distance, kNearWall_m - kStart_m, 0.25);
  }
  EXPECT_EQ(octomap("octomap_binary").header.frame_id, "odom");
}

TEST_F(MappingAsker, WhatWasSeenIsClearedInTheMapsFrame) {
  ASSERT_TRUE(shows(kNearWall_m, CorridorState::BLOCKED));
  octomap_msgs::BoundingBoxQuery clear;  // around the wall: 2 m along y
  clear.request.min.x = -1.0;
  clear.request.max.x = 1.0;
  clear.request.min.y = 1.5;
  clear.request.max.y = 2.5;
  clear.request.max.z = 3.0;
  ASSERT_TRUE(call("clear_bbx", clear));
  EXPECT_EQ(read(octomap("octomap_full"))->search(0.05, 1.95, 1.55), nullptr);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "rostest_services");
  return RUN_ALL_TESTS();
}
