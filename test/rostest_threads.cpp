#include <flight_corridor/CorridorState.h>
#include <flight_corridor/QueryCorridor.h>
#include <gtest/gtest.h>
#include <nodelet/loader.h>
#include <octomap_msgs/BoundingBoxQuery.h>
#include <octomap_msgs/GetOctomap.h>
#include <ros/ros.h>
#include <sensor_msgs/Imu.h>
#include <std_srvs/Empty.h>
#include <topic_tools/shape_shifter.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "ros/node.hpp"
#include "support/stereo_inputs.hpp"

// Sensors, questions and subscribers, each in a thread of its own, while the node comes and goes: nothing hangs, ends
// the process or, with AddressSanitizer, touches what is gone.

namespace flight_corridor_ros {
namespace {

using flight_corridor::CorridorState;
using test_support::RigTopics;
using test_support::StereoInputs;

constexpr int kLives = 3;           // of a node
constexpr int kVerdicts = 4;        // in each of them
constexpr double kPatience_s = 60;  // AddressSanitizer makes a pair last for seconds

/// Does work again and again in a thread of its own.
class Repeated {
 public:
  Repeated(double pause_s, std::function<void()> work)
      : thread_([this, pause_s, work = std::move(work)] {
          while (!ends_) {
            work();
            ros::WallDuration(pause_s).sleep();
          }
        }) {}
  ~Repeated() {
    ends_ = true;
    thread_.join();
  }
  Repeated(const Repeated&) = delete;
  Repeated& operator=(const Repeated&) = delete;

 private:
  std::atomic<bool> ends_{false};
  std::thread thread_;  // last: it reads what is before it
};

class ThreadsTest : public testing::Test {
 protected:
  template <typename Service>
  void ask(const std::string& name, typename Service::Request request = {}) {
    typename Service::Response response;
    answered_ += ros::service::call("~corridor/" + name, request, response);
  }

  void sendPair() {
    StereoInputs inputs(6.0, ++seed_);
    inputs.stamp(ros::Time::now());
    rig_.send(inputs);
  }

  void sendImu() {
    sensor_msgs::Imu message;
    message.header.stamp = ros::Time::now();
    message.header.frame_id = "left_optical";
    imu_.publish(message);
  }

  void askAll() {
    flight_corridor::QueryCorridorRequest question;
    question.pose.header.frame_id = "left_optical";
    question.pose.pose.position.z = 1.0;
    question.pose.pose.orientation.w = 1.0;
    question.length = question.width = question.height = 0.5;
    ask<flight_corridor::QueryCorridor>("query_corridor", question);
    ask<octomap_msgs::GetOctomap>("octomap_full");
    ask<octomap_msgs::BoundingBoxQuery>("clear_bbx");
    ask<std_srvs::Empty>("reset");
  }

  /// Listens to every topic for a while.
  void listen() {
    std::vector<ros::Subscriber> subscribers;
    for (const char* topic : {"free", "range_fused", "points", "obstacles", "clearing", "disparity", "depth/image_rect",
                              "evidence", "overlay", "octomap_full", "occupied_cells_vis_array", "projected_map"}) {
      subscribers.push_back(node_.subscribe<topic_tools::ShapeShifter>(
          std::string("corridor/") + topic, 1, [this](const topic_tools::ShapeShifter::ConstPtr&) { ++heard_; }));
    }
    ros::WallDuration(0.5).sleep();
  }

  /// Until the node has answered some pairs.
  void expectVerdicts() {
    const int before = verdicts_;
    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kPatience_s);
    while (verdicts_ < before + kVerdicts && ros::WallTime::now() < deadline) ros::WallDuration(0.01).sleep();
    EXPECT_GE(verdicts_, before + kVerdicts);
  }

  std::atomic<int> verdicts_{0}, answered_{0}, heard_{0};
  std::uint64_t seed_ = 0;
  ros::NodeHandle node_{"~"};
  RigTopics rig_;
  ros::Publisher imu_ = ros::NodeHandle().advertise<sensor_msgs::Imu>("/imu", 5);
  ros::Subscriber states_ =
      node_.subscribe<CorridorState>("corridor/corridor", 10, [this](const CorridorState::ConstPtr& state) {
        if (!(state->reasons & CorridorState::NO_DATA)) ++verdicts_;
      });
};

TEST_F(ThreadsTest, ANodeComesAndGoesAmongThoseWhoAskIt) {
  ros::AsyncSpinner spinner(4);
  spinner.start();
  const Repeated pairs(0.1, [this] { sendPair(); });
  const Repeated imu(0.01, [this] { sendImu(); });
  const Repeated questions(0.05, [this] { askAll(); });
  const Repeated listeners(0.05, [this] { listen(); });
  for (int life = 0; life < kLives; ++life) {
    Node node(ros::NodeHandle("/stereo"), ros::NodeHandle("~corridor"));
    expectVerdicts();
  }
  EXPECT_GT(answered_, 0);
  EXPECT_GT(heard_, 0);
}

TEST_F(ThreadsTest, ANodeletComesAndGoesAmongThoseWhoAskIt) {
  ros::AsyncSpinner spinner(4);
  spinner.start();
  const Repeated pairs(0.1, [this] { sendPair(); });
  const Repeated questions(0.05, [this] { askAll(); });
  const Repeated listeners(0.05, [this] { listen(); });
  const std::string name = ros::names::resolve("~corridor");
  nodelet::M_string remappings;
  for (const char* topic : {"left/image_rect", "left/camera_info", "right/image_rect", "right/camera_info"}) {
    remappings[topic] = std::string("/stereo/") + topic;
  }
  nodelet::Loader loader(false);
  for (int life = 0; life < kLives; ++life) {
    ASSERT_TRUE(loader.load(name, "flight_corridor/Corridor", remappings, {}));
    expectVerdicts();
    ASSERT_TRUE(loader.unload(name));
  }
}

TEST_F(ThreadsTest, ARefusedNodeletLoadsUnderItsNameOnceItIsMended) {
  const std::string name = ros::names::resolve("~refused");
  nodelet::Loader loader(false);
  const std::vector<std::pair<std::string, XmlRpc::XmlRpcValue>> wrong{{"/map/resolution_m", -1.0},
                                                                       {"/corridor/width_m", "broad"},
                                                                       {"/no_such_key", 1},
                                                                       {"/ros/image_transport", "pigeon"}};
  for (const auto& [key, value] : wrong) {
    ros::param::set(name + key, value);
    EXPECT_FALSE(loader.load(name, "flight_corridor/Corridor", {}, {})) << key;
    EXPECT_FALSE(loader.load(name, "flight_corridor/Corridor", {}, {})) << key;
    ros::param::del(name);
    ASSERT_TRUE(loader.load(name, "flight_corridor/Corridor", {}, {})) << key;
    ASSERT_TRUE(loader.unload(name));
    ros::param::del(name);
  }
}

}  // namespace
}  // namespace flight_corridor_ros

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "threads");
  return RUN_ALL_TESTS();
}
