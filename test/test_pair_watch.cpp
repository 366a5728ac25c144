#include <gtest/gtest.h>

#include "ros/pair_watch.hpp"

namespace flight_corridor_ros {
namespace {

const std::array<std::string, 4> kNames{"/l/image_rect", "/l/camera_info", "/r/image_rect", "/r/camera_info"};

sensor_msgs::CameraInfo calibrated() {
  sensor_msgs::CameraInfo info;
  info.K[0] = info.P[0] = 350.0;
  return info;
}

class PairWatchTest : public testing::Test {
 protected:
  void hearImages(double now_s) {
    watch.hear(PairWatch::kLeft, sensor_msgs::Image(), now_s);
    watch.hear(PairWatch::kRight, sensor_msgs::Image(), now_s);
  }
  void hearInfos(const sensor_msgs::CameraInfo& info, double now_s) {
    watch.hear(PairWatch::kLeftInfo, info, now_s);
    watch.hear(PairWatch::kRightInfo, info, now_s);
  }
  testing::AssertionResult says(const std::string& text) const {
    const std::string explanation = watch.explain(kNames, 10.0, "equal");
    if (explanation.find(text) != std::string::npos) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "it says: " << explanation;
  }

  PairWatch watch;
};

TEST_F(PairWatchTest, NamesEveryTopicThatWasNeverHeard) {
  EXPECT_TRUE(says("No CameraInfo on /l/camera_info, /r/camera_info."));
  EXPECT_TRUE(says("No image on /l/image_rect, /r/image_rect."));
}

TEST_F(PairWatchTest, SaysWhatToDoWithoutCalibration) {
  hearImages(11.0);
  EXPECT_TRUE(says("No CameraInfo on /l/camera_info, /r/camera_info. Calibrate the cameras"));
  EXPECT_FALSE(says("No image"));
}

TEST_F(PairWatchTest, NamesCameraInfosThatHoldNoCalibration) {
  hearInfos(sensor_msgs::CameraInfo(), 11.0);
  EXPECT_TRUE(says("Not calibrated (K or P is 0): /l/camera_info, /r/camera_info. Calibrate the cameras"));
  EXPECT_TRUE(says("No image on /l/image_rect, /r/image_rect."));  // image_proc rectifies none of these cameras'
  EXPECT_FALSE(says("No CameraInfo"));
}

TEST_F(PairWatchTest, NamesATopicThatFellSilent) {
  hearImages(11.0);
  hearInfos(calibrated(), 11.0);
  watch.hear(PairWatch::kRight, sensor_msgs::Image(), 9.0);
  EXPECT_TRUE(says("No image on /r/image_rect."));
}

TEST_F(PairWatchTest, KnowsSilenceFromWhatNeverCame) {
  hearImages(9.0);
  hearInfos(calibrated(), 9.0);
  EXPECT_TRUE(says("All four topics came before and are silent now"));
  EXPECT_FALSE(says("Calibrate"));
}

TEST_F(PairWatchTest, AsksForTheStampsWhenAllCameWithoutAPair) {
  hearImages(11.0);
  hearInfos(calibrated(), 11.0);
  EXPECT_TRUE(says("Needed are equal ones on /l/image_rect, /l/camera_info, /r/image_rect, /r/camera_info"));
}

}  // namespace
}  // namespace flight_corridor_ros
