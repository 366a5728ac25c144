#include <flight_corridor/CorridorState.h>
#include <geometry_msgs/TransformStamped.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Range.h>
#include <std_msgs/Bool.h>
#include <tf2_eigen/tf2_eigen.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <cmath>
#include <functional>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>

#include "flight_corridor/corridor.hpp"
#include "flight_corridor/types.hpp"
#include "ros/conversions.hpp"

namespace {

using flight_corridor::CorridorState;

constexpr double kFocal_px = 350.0, kBaseline_m = 0.12, kWall_m = 2.0;
constexpr double kPatience_s = 30.0;  // a loaded machine may need seconds for a first answer

/// A textured wall across the view, as one stereo pair with its CameraInfos and a LiDAR reading.
struct Inputs {
  sensor_msgs::ImagePtr left, right;
  sensor_msgs::CameraInfo left_info, right_info;
  sensor_msgs::Range range;

  Inputs() {
    const int disparity_px = static_cast<int>(kFocal_px * kBaseline_m / kWall_m);
    cv::Mat texture(480, 640 + disparity_px, CV_8UC1);
    cv::RNG random(1);
    random.fill(texture, cv::RNG::UNIFORM, 0, 255);
    cv::GaussianBlur(texture, texture, {0, 0}, 1.5);
    const cv::Rect left_view(0, 0, 640, 480), right_view(disparity_px, 0, 640, 480);
    left = flight_corridor_ros::toImage({}, texture(left_view), "mono8");
    right = flight_corridor_ros::toImage({}, texture(right_view), "mono8");
    left_info = cameraInfo(0.0);
    right_info = cameraInfo(-kFocal_px * kBaseline_m);
    range.field_of_view = 0.03f;
    range.min_range = 0.2f;
    range.max_range = 100.0f;
    range.range = static_cast<float>(kWall_m);
  }

  static sensor_msgs::CameraInfo cameraInfo(double p3) {
    sensor_msgs::CameraInfo info;
    info.width = 640;
    info.height = 480;
    info.P = {kFocal_px, 0, 319.5, p3, 0, kFocal_px, 239.5, 0, 0, 0, 1, 0};
    return info;
  }

  void stamp(const ros::Time& time) {
    left->header.stamp = right->header.stamp = left_info.header.stamp = right_info.header.stamp = time;
    left->header.frame_id = right->header.frame_id = "left_optical";
    left_info.header = left->header;
    right_info.header = right->header;
    range.header.stamp = time;
    range.header.frame_id = "range_link";
  }
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
  }

  /// Whether a verdict that meets the condition comes while the inputs are sent; `age_s` old ones.
  ::testing::AssertionResult answers(Inputs& inputs, const Condition& condition, double age_s = 0.0) {
    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kPatience_s);
    newest_.reset();
    while (ros::ok() && ros::WallTime::now() < deadline) {
      inputs.stamp(ros::Time::now() - ros::Duration(age_s));
      send(inputs);
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

 private:
  static tf2_ros::StaticTransformBroadcaster& broadcaster() {
    static tf2_ros::StaticTransformBroadcaster broadcaster;
    return broadcaster;
  }

  void send(const Inputs& inputs) {
    range_.publish(inputs.range);
    left_info_.publish(inputs.left_info);
    right_info_.publish(inputs.right_info);
    left_.publish(inputs.left);
    right_.publish(inputs.right);
  }

  ros::Publisher left_ = node_.advertise<sensor_msgs::Image>("/stereo/left/image_rect", 5);
  ros::Publisher right_ = node_.advertise<sensor_msgs::Image>("/stereo/right/image_rect", 5);
  ros::Publisher left_info_ = node_.advertise<sensor_msgs::CameraInfo>("/stereo/left/camera_info", 5);
  ros::Publisher right_info_ = node_.advertise<sensor_msgs::CameraInfo>("/stereo/right/camera_info", 5);
  ros::Publisher range_ = node_.advertise<sensor_msgs::Range>("/range", 5);
  ros::Subscriber verdicts_, free_;
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

TEST_F(NodeInputs, OldPairsAreNoData) {
  Inputs inputs;
  EXPECT_TRUE(refuses(inputs, CorridorState::NO_DATA, 5.0));
}

TEST_F(NodeInputs, PairsFromTheFutureAreNoData) {
  Inputs inputs;
  EXPECT_TRUE(refuses(inputs, CorridorState::NO_DATA, -5.0));
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
