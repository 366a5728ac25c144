#include <flight_corridor/CorridorState.h>
#include <flight_corridor/QueryCorridor.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>
#include <octomap_msgs/BoundingBoxQuery.h>
#include <octomap_msgs/Octomap.h>
#include <ros/ros.h>
#include <std_srvs/Empty.h>
#include <tf2_eigen/tf2_eigen.h>

#include <atomic>
#include <cmath>
#include <optional>
#include <thread>
#include <utility>

#include "support/asker.hpp"

namespace flight_corridor_ros {
namespace {

using flight_corridor::CorridorState;
using flight_corridor::QueryCorridor;
using flight_corridor::QueryCorridorResponse;
using octomap_msgs::Octomap;
using test_support::ahead_C;
using test_support::Asker;
using test_support::kFarWall_m;
using test_support::kNearWall_m;
using test_support::kPairPatience_s;
using test_support::kPatience_s;
using test_support::kStart_m;
using test_support::kWatchdog_s;
using test_support::MappingAsker;

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

TEST_F(Asker, PairsAreAnsweredWhileAnotherClientAsksWithoutPause) {
  std::atomic<bool> enough{false};
  int answers = 0;
  std::thread client([&] {
    while (!enough) answers += askAhead().success;
  });
  for (int pair = 0; pair < 10; ++pair) EXPECT_TRUE(answersPair(kFarWall_m)) << "pair " << pair;
  enough = true;
  client.join();
  EXPECT_GT(answers, 0);
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
}  // namespace flight_corridor_ros

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "rostest_services");
  return RUN_ALL_TESTS();
}
