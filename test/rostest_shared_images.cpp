#include <gtest/gtest.h>
#include <nodelet/loader.h>
#include <ros/ros.h>

#include <optional>
#include <set>
#include <string>

#include "ros/conversions.hpp"
#include "ros/stereo_subscriber.hpp"
#include "support/stereo_inputs.hpp"

// Raw images in a nodelet manager, as raw_stereo.launch sets it up: nothing copies them on their way to the matcher.

namespace flight_corridor_ros {
namespace {

constexpr double kPatience_s = 30.0;  // a loaded machine may need seconds for a first answer

class SharedImages : public testing::Test {
 protected:
  SharedImages() {
    for (const std::string side : {"/stereo/left", "/stereo/right"}) {
      for (const std::string name : {"debayer", "rectify"}) {
        // Names of a nodelet's topics are relative to its namespace.
        EXPECT_TRUE(loader_.load(side + "/" + name, "image_proc/" + name, {}, {}));
      }
      rectified_.push_back(node_.subscribe<sensor_msgs::Image>(
          side + "/image_rect", 5,
          [this](const sensor_msgs::ImageConstPtr& image) { rectified_data_.insert(image->data.data()); }));
    }
  }

  /// Sends raw pairs until one has come through to the corridor's subscriber.
  void exchange(const std::vector<double>& distortion) {
    StereoInputs inputs(3.0);
    for (auto* info : {&inputs.left_info, &inputs.right_info}) {
      info->distortion_model = "plumb_bob";
      info->D = distortion;
      info->K = {StereoInputs::kFocal_px, 0, 319.5, 0, StereoInputs::kFocal_px, 239.5, 0, 0, 1};
      info->R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    }
    pair_.reset();
    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kPatience_s);
    while (!pair_ && ros::WallTime::now() < deadline) {
      inputs.stamp(ros::Time::now());
      send(inputs);
      ros::WallDuration(0.1).sleep();
      ros::spinOnce();
    }
  }

  std::optional<StereoMessages> pair_;
  std::set<const std::uint8_t*> raw_data_, rectified_data_;

 private:
  using StereoInputs = test_support::StereoInputs;

  void send(const StereoInputs& inputs) {
    const auto left = boost::make_shared<sensor_msgs::Image>(*inputs.left);
    const auto right = boost::make_shared<sensor_msgs::Image>(*inputs.right);
    kept_.insert(kept_.end(), {left, right});  // else their memory is used again
    raw_data_.insert({left->data.data(), right->data.data()});
    left_info_.publish(inputs.left_info);
    right_info_.publish(inputs.right_info);
    left_.publish(sensor_msgs::ImageConstPtr(left));
    right_.publish(sensor_msgs::ImageConstPtr(right));
  }

  ros::NodeHandle node_;
  nodelet::Loader loader_{false};
  std::vector<sensor_msgs::ImageConstPtr> kept_;
  std::vector<ros::Subscriber> rectified_;
  ros::Publisher left_ = node_.advertise<sensor_msgs::Image>("/stereo/left/image_raw", 5);
  ros::Publisher right_ = node_.advertise<sensor_msgs::Image>("/stereo/right/image_raw", 5);
  ros::Publisher left_info_ = node_.advertise<sensor_msgs::CameraInfo>("/stereo/left/camera_info", 5);
  ros::Publisher right_info_ = node_.advertise<sensor_msgs::CameraInfo>("/stereo/right/camera_info", 5);
  StereoSubscriber subscriber_{ros::NodeHandle("/stereo"), RosConfig(),
                               [this](const StereoMessages& pair) { pair_ = pair; }};
};

TEST_F(SharedImages, WithoutDistortionTheMatcherSeesTheDriversMemory) {
  exchange({0.0, 0.0, 0.0, 0.0, 0.0});
  ASSERT_TRUE(pair_);
  for (const auto& image : {pair_->left, pair_->right}) {
    EXPECT_TRUE(raw_data_.count(image->data.data()));
    EXPECT_EQ(toGrey(image)->image.data, image->data.data());
  }
}

TEST_F(SharedImages, WithDistortionItSeesWhatWasRectified) {
  exchange({-0.05, 0.0, 0.0, 0.0, 0.0});
  ASSERT_TRUE(pair_);
  for (const auto& image : {pair_->left, pair_->right}) {
    EXPECT_FALSE(raw_data_.count(image->data.data()));
    EXPECT_TRUE(rectified_data_.count(image->data.data()));
    EXPECT_EQ(toGrey(image)->image.data, image->data.data());
  }
}

}  // namespace
}  // namespace flight_corridor_ros

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "shared_images");
  return RUN_ALL_TESTS();
}
