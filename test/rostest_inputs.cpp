#include <flight_corridor/CorridorState.h>
#include <geometry_msgs/TransformStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <octomap_msgs/Octomap.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Log.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Bool.h>
#include <stereo_msgs/DisparityImage.h>
#include <tf2_eigen/tf2_eigen.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <visualization_msgs/Marker.h>
#include <visualization_msgs/MarkerArray.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "flight_corridor/corridor/corridor.hpp"
#include "flight_corridor/types.hpp"
#include "ros/conversions.hpp"
#include "support/stereo_inputs.hpp"

namespace {

using flight_corridor::CorridorState;

constexpr double kWall_m = 2.0;
constexpr double kPatience_s = 30.0;  // a loaded machine may need seconds for a first answer

struct Inputs : flight_corridor_ros::test_support::StereoInputs {
  Inputs() : StereoInputs(kWall_m) {}
};

/// Publishes inputs and waits for what the node says to them.
class NodeInputs : public testing::Test {
 protected:
  using Condition = std::function<bool(const CorridorState&)>;

  explicit NodeInputs(const std::string& name = "/flight_corridor") {
    verdicts_ = node_.subscribe<CorridorState>(name + "/corridor", 10,
                                               [this](const CorridorState::ConstPtr& message) { newest_ = *message; });
    free_ = node_.subscribe<std_msgs::Bool>(
        name + "/free", 10, [this](const std_msgs::Bool::ConstPtr& message) { says_free_ = message->data; });
    markers_ = node_.subscribe<visualization_msgs::Marker>(
        name + "/corridor_marker", 10,
        [this](const visualization_msgs::Marker::ConstPtr& message) { marker_action_ = message->action; });
  }

  /// Whether a verdict that meets the condition comes while the inputs are sent; `age_s` old ones.
  ::testing::AssertionResult answers(Inputs& inputs, const Condition& condition, double age_s = 0.0) {
    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kPatience_s);
    newest_.reset();
    while (ros::ok() && ros::WallTime::now() < deadline) {
      inputs.stamp(ros::Time::now() - ros::Duration(age_s));
      rig_.send(inputs);
      ros::WallDuration(0.1).sleep();
      ros::spinOnce();
      if (newest_ && condition(*newest_)) return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure() << "the last verdict was "
                                         << (newest_ ? describe(*newest_) : std::string("never given"));
  }

  ::testing::AssertionResult refuses(Inputs& inputs, std::uint32_t reason, double age_s = 0.0) {
    return answers(
        inputs,
        [reason](const CorridorState& verdict) {
          return verdict.state == CorridorState::UNKNOWN && (verdict.reasons & reason);
        },
        age_s);
  }

  ::testing::AssertionResult sees(Inputs& inputs) {
    return answers(inputs, [](const CorridorState& verdict) { return verdict.state == CorridorState::BLOCKED; });
  }

  static void mountLidar() {
    geometry_msgs::TransformStamped mount = tf2::eigenToTransform(flight_corridor::opticalFromForward());
    mount.header.frame_id = "left_optical";
    mount.child_frame_id = "range_link";
    broadcaster().sendTransform(mount);
  }

  static std::string describe(const CorridorState& verdict) {
    return flight_corridor::toString(static_cast<flight_corridor::State>(verdict.state)) + std::string(" ") +
           flight_corridor::describeReasons(verdict.reasons);
  }

  ros::NodeHandle node_;
  std::optional<CorridorState> newest_;
  std::optional<bool> says_free_;
  std::optional<int> marker_action_;

 private:
  static tf2_ros::StaticTransformBroadcaster& broadcaster() {
    static tf2_ros::StaticTransformBroadcaster broadcaster;
    return broadcaster;
  }

  flight_corridor_ros::test_support::RigTopics rig_;
  ros::Subscriber verdicts_, free_, markers_;
};

class MappingNodeInputs : public NodeInputs {
 protected:
  MappingNodeInputs() : NodeInputs("/mapping") {}
};

// The cases run in this order: the LiDAR is mounted by the second and stays so.

TEST_F(NodeInputs, AWallIsSeenWithoutTheLidarsPlace) {
  Inputs inputs;
  EXPECT_TRUE(answers(inputs, [](const CorridorState& verdict) {
    return verdict.state == CorridorState::BLOCKED && (verdict.reasons & CorridorState::NO_LIDAR);
  }));
  EXPECT_EQ(newest_->header.frame_id, "left_optical");
  EXPECT_NEAR(newest_->clear_distance, kWall_m, 0.25);
}

TEST_F(NodeInputs, TheLidarIsUsedOnceTfKnowsItsPlace) {
  mountLidar();
  Inputs inputs;
  EXPECT_TRUE(answers(inputs, [](const CorridorState& verdict) {
    return verdict.state == CorridorState::BLOCKED && !(verdict.reasons & CorridorState::NO_LIDAR);
  }));
  EXPECT_NEAR(newest_->range_lidar, kWall_m, 1e-3);
  EXPECT_NEAR(newest_->range_fused, kWall_m, 0.05);
}

TEST_F(NodeInputs, ANanRangeLeavesStereoToAnswer) {
  Inputs inputs;
  inputs.range.range = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(answers(inputs, [](const CorridorState& verdict) {
    return verdict.state == CorridorState::BLOCKED &&
           (verdict.reasons & (CorridorState::NO_LIDAR | CorridorState::LIDAR_REJECTED));
  }));
}

TEST_F(NodeInputs, AnUnknownEncodingIsABadImage) {
  Inputs inputs;
  inputs.right->encoding = "smell8";
  EXPECT_TRUE(refuses(inputs, CorridorState::BAD_IMAGE));
  EXPECT_EQ(says_free_, false);
  EXPECT_TRUE(std::isnan(newest_->clear_distance));
}

TEST_F(NodeInputs, AnEmptyImageIsABadImage) {
  Inputs inputs;
  inputs.left->data.clear();
  inputs.left->width = inputs.left->height = inputs.left->step = 0;
  EXPECT_TRUE(refuses(inputs, CorridorState::BAD_IMAGE));
}

TEST_F(NodeInputs, ImagesOfDifferentSizesAreBadImages) {
  Inputs inputs;
  inputs.right = flight_corridor_ros::toImage({}, cv::Mat(240, 320, CV_8UC1, cv::Scalar(9)), "mono8");
  EXPECT_TRUE(refuses(inputs, CorridorState::BAD_IMAGE));
}

TEST_F(NodeInputs, AZeroBaselineIsABadCalibration) {
  Inputs inputs;
  inputs.right_info.P[3] = 0.0;
  EXPECT_TRUE(refuses(inputs, CorridorState::BAD_CALIBRATION));
}

TEST_F(NodeInputs, ABlankViewIsNoDisparity) {
  Inputs inputs;
  inputs.range.range = std::numeric_limits<float>::infinity();  // nothing in range
  for (auto* image : {&inputs.left, &inputs.right}) std::fill((*image)->data.begin(), (*image)->data.end(), 128);
  EXPECT_TRUE(refuses(inputs, CorridorState::NO_DISPARITY));
}

TEST_F(NodeInputs, OdometryTellsTheMotionThatABlankViewDoesNot) {
  Inputs inputs;
  for (auto* image : {&inputs.left, &inputs.right}) std::fill((*image)->data.begin(), (*image)->data.end(), 128);
  const auto motion = [](bool is_known) {
    return
        [is_known](const CorridorState& verdict) { return !(verdict.reasons & CorridorState::NO_MOTION) == is_known; };
  };
  EXPECT_TRUE(answers(inputs, motion(false)));
  ros::Publisher publisher = node_.advertise<nav_msgs::Odometry>("odom", 10);
  const ros::Timer sending = node_.createTimer(ros::Duration(0.01), [&](const ros::TimerEvent&) {
    nav_msgs::Odometry odometry;
    odometry.header.stamp = ros::Time::now();
    odometry.header.frame_id = "odom";
    odometry.child_frame_id = "left_optical";
    odometry.pose.pose.orientation.w = 1.0;
    publisher.publish(odometry);
  });
  EXPECT_TRUE(answers(inputs, motion(true), 0.05));
}

TEST_F(NodeInputs, OldPairsAreNoDataAndShowNoBox) {
  Inputs inputs;
  ASSERT_TRUE(
      answers(inputs, [this](const CorridorState&) { return marker_action_ == visualization_msgs::Marker::ADD; }));
  EXPECT_TRUE(answers(
      inputs,
      [this](const CorridorState& verdict) {
        return verdict.reasons == CorridorState::NO_DATA && marker_action_ == visualization_msgs::Marker::DELETE;
      },
      5.0));
}

TEST_F(NodeInputs, PairsFromTheFutureAreNoData) {
  Inputs inputs;
  EXPECT_TRUE(refuses(inputs, CorridorState::NO_DATA, -5.0));
}

TEST_F(NodeInputs, ACamerasClockThatIsAnHourAheadIsNamedInTheLog) {
  Inputs inputs;
  std::string named;
  const ros::Subscriber log =
      node_.subscribe<rosgraph_msgs::Log>("/rosout", 100, [&](const rosgraph_msgs::Log::ConstPtr& message) {
        if (message->msg.find("(1.0 h) ahead of the clock") != std::string::npos) named = message->msg;
      });
  EXPECT_TRUE(answers(
      inputs, [&](const CorridorState&) { return !named.empty(); }, -3600.0));
  for (const char* part : {"stereo pair is stamped 3", "corridor/max_age_s", "synchronise the clocks", "local time"}) {
    EXPECT_NE(named.find(part), std::string::npos) << part << " in: " << named;
  }
}

TEST_F(NodeInputs, SilenceIsNoData) {
  newest_.reset();
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(2.0);
  while (ros::WallTime::now() < end) {
    ros::WallDuration(0.05).sleep();
    ros::spinOnce();
  }
  ASSERT_TRUE(newest_);
  EXPECT_EQ(newest_->state, CorridorState::UNKNOWN);
  EXPECT_EQ(newest_->reasons, CorridorState::NO_DATA);
  EXPECT_EQ(newest_->header.frame_id, "left_optical");
  EXPECT_EQ(says_free_, false);
}

/// Frames by topic of what a node publishes.
class Frames {
 public:
  template <typename Message>
  void listen(const std::string& topic) {
    subscribers_.push_back(node_.subscribe<Message>("/flight_corridor/" + topic, 1, [this, topic](const auto& message) {
      frames_[topic] = message->header.frame_id;
    }));
  }
  void listenToMarkers(const std::string& topic) {
    subscribers_.push_back(node_.subscribe<visualization_msgs::MarkerArray>(
        "/flight_corridor/" + topic, 1, [this, topic](const visualization_msgs::MarkerArray::ConstPtr& array) {
          for (const auto& marker : array->markers) frames_[topic] = marker.header.frame_id;
        }));
  }
  bool haveCome() const { return frames_.size() == subscribers_.size(); }
  const std::map<std::string, std::string>& byTopic() const { return frames_; }

 private:
  ros::NodeHandle node_;
  std::vector<ros::Subscriber> subscribers_;
  std::map<std::string, std::string> frames_;
};

TEST_F(NodeInputs, ALeadingSlashGoesOutOnNoTopic) {
  Frames frames;
  frames.listen<CorridorState>("corridor");
  frames.listen<sensor_msgs::Range>("range_fused");
  for (const char* topic : {"points", "obstacles", "clearing", "octomap_point_cloud_centers"}) {
    frames.listen<sensor_msgs::PointCloud2>(topic);
  }
  frames.listen<stereo_msgs::DisparityImage>("disparity");
  frames.listen<sensor_msgs::Image>("depth/image_rect");
  frames.listen<sensor_msgs::CameraInfo>("depth/camera_info");
  frames.listen<sensor_msgs::Image>("overlay");
  frames.listen<octomap_msgs::Octomap>("octomap_binary");
  frames.listen<octomap_msgs::Octomap>("octomap_full");
  frames.listenToMarkers("occupied_cells_vis_array");
  frames.listenToMarkers("free_cells_vis_array");
  frames.listen<visualization_msgs::Marker>("corridor_marker");
  Inputs inputs;
  inputs.frame_prefix = "/";
  ASSERT_TRUE(answers(inputs, [&](const CorridorState&) { return frames.haveCome(); }));
  for (const auto& [topic, frame] : frames.byTopic()) {
    EXPECT_EQ(frame, topic == "range_fused" ? "range_link" : "left_optical") << topic;
  }
}

TEST_F(NodeInputs, ABaselineInMillimetresIsABadCalibration) {
  Inputs inputs;
  inputs.right_info.P[3] *= 1000.0;
  EXPECT_TRUE(refuses(inputs, CorridorState::BAD_CALIBRATION));
}

TEST_F(NodeInputs, AfterAllThatTheWallIsSeenAgain) {
  Inputs inputs;
  EXPECT_TRUE(sees(inputs));
}

TEST_F(MappingNodeInputs, WithoutAPoseInTheMapsFrameThereIsNoVerdict) {
  Inputs inputs;
  EXPECT_TRUE(refuses(inputs, CorridorState::NO_POSE));
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "rostest_inputs");
  return RUN_ALL_TESTS();
}
