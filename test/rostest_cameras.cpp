#include <flight_corridor/CorridorState.h>
#include <gtest/gtest.h>
#include <ros/network.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Log.h>
#include <sensor_msgs/Range.h>
#include <tf2_eigen/tf2_eigen.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <xmlrpcpp/XmlRpc.h>

#include <functional>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "flight_corridor/corridor/corridor.hpp"
#include "ros/camera_info_file.hpp"
#include "ros/conversions.hpp"
#include "sim/render.hpp"
#include "sim/rig.hpp"
#include "sim/scene_parts.hpp"

// A simulated wall before a camera, in the topics, frames and encodings of its driver; the launch file's comment says
// where those are documented.

namespace flight_corridor_ros {
namespace {

using flight_corridor::CorridorState;
using flight_corridor::StereoCalibration;
namespace sim = flight_corridor::sim;

constexpr double kPatience_s = 40.0;  // a loaded machine may need seconds for a first answer
constexpr double kNear_m = 2.5, kFar_m = 7.0;
const Eigen::Vector3d kLidar_F(0.05, -0.04, -0.03);  // lidar_pose of cameras.test
const std::string kCalibrations = FLIGHT_CORRIDOR_SOURCE_DIR "/config/euroc/";

struct Eye {
  std::string image, info, image_frame, info_frame;
};

struct Kind {
  Eye left, right;
  std::string encoding, lidar_parent;
  StereoCalibration rig;
  bool is_raw = false;         ///< Distorted as the calibration files say.
  double right_delay_s = 0.0;  ///< Of the right stamps.
};

const Kind& kindOf(const std::string& camera) {
  static const std::map<std::string, Kind> kinds{
      {"zed",
       {{"zed2i/zed_node/left/image_rect_gray", "zed2i/zed_node/left/camera_info", "zed2i_left_camera_optical_frame",
         "zed2i_left_camera_optical_frame"},
        {"zed2i/zed_node/right/image_rect_gray", "zed2i/zed_node/right/camera_info", "zed2i_right_camera_optical_frame",
         "zed2i_right_camera_optical_frame"},
        "mono8",
        "zed2i_left_camera_frame",
        {{640, 360}, 265.0, 265.0, 322.0, 178.0, 322.0, 0.12}}},
      {"realsense",
       {{"camera/infra1/image_rect_raw", "camera/infra1/camera_info", "camera_infra1_optical_frame",
         "camera_infra1_optical_frame"},
        {"camera/infra2/image_rect_raw", "camera/infra2/camera_info", "camera_infra2_optical_frame",
         "camera_infra1_optical_frame"},
        "mono8",
        "camera_infra1_frame",
        {{848, 480}, 425.0, 425.0, 424.0, 240.0, 424.0, 0.05}}},
      {"oakd",
       {{"oak/left/image_raw", "oak/left/camera_info", "oak_left_camera_optical_frame",
         "oak_left_camera_optical_frame"},
        {"oak/right/image_raw", "oak/right/camera_info", "oak_right_camera_optical_frame",
         "oak_right_camera_optical_frame"},
        "mono8",
        "oak_left_camera_frame",
        {{1280, 720}, 800.0, 800.0, 640.0, 360.0, 640.0, 0.075},
        false,
        0.001}},
      {"euroc",
       {{"cam0/image_raw", "", "cam0", ""}, {"cam1/image_raw", "", "cam1", ""}, "mono8", "base_link", {}, true}},
      {"raw_stereo",
       {{"stereo/left/image_raw", "stereo/left/camera_info", "left_optical", "left_optical"},
        {"stereo/right/image_raw", "stereo/right/camera_info", "right_optical", "right_optical"},
        "bayer_rggb8",
        "base_link",
        {},
        true}}};
  return kinds.at(camera);
}

sensor_msgs::CameraInfo rectifiedInfo(const StereoCalibration& rig, double cx_px, double baseline_m) {
  sensor_msgs::CameraInfo info;
  info.width = static_cast<std::uint32_t>(rig.size_px.width);
  info.height = static_cast<std::uint32_t>(rig.size_px.height);
  info.distortion_model = "plumb_bob";
  info.D.resize(5, 0.0);
  info.K = {rig.fx_px, 0, cx_px, 0, rig.fy_px, rig.cy_px, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {rig.fx_px, 0, cx_px, -rig.fx_px * baseline_m, 0, rig.fy_px, rig.cy_px, 0, 0, 0, 1, 0};
  return info;
}

/// Where the rectified image shows what each raw pixel shows.
cv::Mat rectifiedFromRaw(const sensor_msgs::CameraInfo& info) {
  std::vector<cv::Point2f> raw, rectified;
  for (std::uint32_t v = 0; v < info.height; ++v) {
    for (std::uint32_t u = 0; u < info.width; ++u) raw.emplace_back(u, v);
  }
  cv::undistortPoints(raw, rectified, cv::Mat(3, 3, CV_64F, const_cast<double*>(info.K.data())), info.D,
                      cv::Mat(3, 3, CV_64F, const_cast<double*>(info.R.data())),
                      cv::Mat(3, 4, CV_64F, const_cast<double*>(info.P.data())));
  return cv::Mat(rectified, true).reshape(2, static_cast<int>(info.height));
}

/// One lens: its view of a wall, as its driver publishes it.
class Lens {
 public:
  Lens(const Eye& eye, const std::string& encoding, const sensor_msgs::CameraInfo& info, bool is_raw)
      : eye_(eye), encoding_(encoding), info_(info) {
    if (is_raw) map_ = rectifiedFromRaw(info);
    image_ = node_.advertise<sensor_msgs::Image>(eye.image, 5);
    if (!eye.info.empty()) infos_ = node_.advertise<sensor_msgs::CameraInfo>(eye.info, 5);
  }

  void lookAt(const std::vector<sim::Primitive>& world, const sim::Camera& camera) {
    radiance_ = sim::render(world, camera).radiance;
  }

  void send(const ros::Time& stamp, std::uint64_t seed, bool is_calibrated) {
    cv::Mat view = sim::expose(radiance_, sim::ImageSensor(), seed);
    if (!map_.empty()) cv::remap(view.clone(), view, map_, cv::noArray(), cv::INTER_LINEAR);
    std_msgs::Header header;
    header.stamp = stamp;
    header.frame_id = eye_.image_frame;
    if (infos_) {
      sensor_msgs::CameraInfo info = info_;
      if (!is_calibrated) {
        info.K.fill(0.0);
        info.P.fill(0.0);
      }
      info.header = header;
      info.header.frame_id = eye_.info_frame;
      infos_.publish(info);
    }
    image_.publish(toImage(header, view, encoding_));
  }

 private:
  ros::NodeHandle node_;
  Eye eye_;
  std::string encoding_;
  sensor_msgs::CameraInfo info_;
  cv::Mat map_, radiance_;
  ros::Publisher image_, infos_;
};

class Cameras : public testing::Test {
 protected:
  using Condition = std::function<bool(const CorridorState&)>;

  Cameras() {
    rig_.calibration = kind_.is_raw ? toCalibration(left_info_, right_info_) : kind_.rig;
    geometry_msgs::TransformStamped mount =
        tf2::eigenToTransform(flight_corridor::opticalFromForward().inverse());  // of the driver's description
    mount.header.frame_id = kind_.lidar_parent;
    mount.child_frame_id = kind_.left.image_frame;
    broadcaster_.sendTransform(mount);
  }

  void lookAtWall(double wall_m) {
    sim::Random random(1, sim::Stream::Scene);
    const std::vector<sim::Primitive> world{
        sim::backdrop(wall_m, sim::masonry(random)),
        sim::makeBox({0, 0, -0.5}, {300, 300, 1}, sim::textured(random, 0.4, 0.25, 0.6))};
    Eigen::Isometry3d T_W_B = Eigen::Isometry3d::Identity();
    T_W_B.translation() = Eigen::Vector3d(0.0, 0.0, sim::kHeight_m) - rig_.T_B_C.translation();
    left_.lookAt(world, sim::leftCamera(rig_, T_W_B));
    right_.lookAt(world, sim::rightCamera(rig_, T_W_B));
    wall_m_ = wall_m;
  }

  void send(bool is_calibrated = true) {
    const ros::Time now = ros::Time::now();
    sensor_msgs::Range range;
    range.header.stamp = now;
    range.header.frame_id = "range_link";
    range.field_of_view = 0.03f;
    range.min_range = 0.2f;
    range.max_range = 100.0f;
    range.range =
        static_cast<float>(wall_m_ - kLidar_F.x() + 1e-4 * (seed_ % 4));  // one that repeats itself may be frozen
    ranges_.publish(range);
    left_.send(now, ++seed_, is_calibrated);
    right_.send(now + ros::Duration(kind_.right_delay_s), ++seed_, is_calibrated);
  }

  /// Whether a verdict that meets the condition comes while pairs are sent.
  testing::AssertionResult answers(const Condition& condition) {
    newest_.reset();
    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kPatience_s);
    while (ros::ok() && ros::WallTime::now() < deadline) {
      send();
      ros::WallDuration(0.1).sleep();
      ros::spinOnce();
      if (newest_ && condition(*newest_)) return testing::AssertionSuccess();
    }
    if (!newest_) return testing::AssertionFailure() << "no verdict";
    return testing::AssertionFailure() << "the last verdict was "
                                       << flight_corridor::toString(static_cast<flight_corridor::State>(newest_->state))
                                       << " " << flight_corridor::describeReasons(newest_->reasons);
  }

  /// Whether the log says a text while something is done.
  bool logSays(const std::string& text, const std::function<void()>& act) {
    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kPatience_s);
    while (log_.find(text) == std::string::npos && ros::WallTime::now() < deadline) {
      act();
      ros::WallDuration(0.1).sleep();
      ros::spinOnce();
    }
    return log_.find(text) != std::string::npos;
  }

  ros::NodeHandle node_;
  const std::string camera_ = ros::param::param<std::string>("~camera", "");
  const Kind& kind_ = kindOf(camera_);
  std::optional<CorridorState> newest_;

 private:
  const sensor_msgs::CameraInfo left_info_ =
      kind_.is_raw ? readCameraInfo(kCalibrations + "left.yaml") : rectifiedInfo(kind_.rig, kind_.rig.cx_px, 0.0);
  const sensor_msgs::CameraInfo right_info_ =
      kind_.is_raw ? readCameraInfo(kCalibrations + "right.yaml")
                   : rectifiedInfo(kind_.rig, kind_.rig.cx_right_px, kind_.rig.baseline_m);
  sim::Rig rig_ = sim::defaultRig();
  Lens left_{kind_.left, kind_.encoding, left_info_, kind_.is_raw};
  Lens right_{kind_.right, kind_.encoding, right_info_, kind_.is_raw};
  double wall_m_ = kNear_m;
  std::string log_;
  static std::uint64_t seed_;
  ros::Publisher ranges_ = node_.advertise<sensor_msgs::Range>("range", 5);
  tf2_ros::StaticTransformBroadcaster broadcaster_;
  ros::Subscriber verdicts_ = node_.subscribe<CorridorState>(
      "flight_corridor/corridor", 10, [this](const CorridorState::ConstPtr& message) { newest_ = *message; });
  ros::Subscriber logs_ = node_.subscribe<rosgraph_msgs::Log>(
      "/rosout", 100, [this](const rosgraph_msgs::Log::ConstPtr& message) { log_ += message->msg + "\n"; });
};

std::uint64_t Cameras::seed_ = 0;

// The cases run in this order: at first nobody has sent anything.

TEST_F(Cameras, WithoutCalibrationTheNodeSaysWhatToDo) {
  if (camera_ != "raw_stereo") GTEST_SKIP() << "rectified by the driver, or its calibration is shipped";
  lookAtWall(kNear_m);
  const std::string infos = node_.resolveName(kind_.left.info) + ", " + node_.resolveName(kind_.right.info);
  EXPECT_TRUE(logSays("No CameraInfo on " + infos + ". Calibrate", [] {}));
  EXPECT_TRUE(logSays("Not calibrated (K or P is 0): " + infos + ". Calibrate", [this] { send(false); }));
}

TEST_F(Cameras, ANearWallBlocks) {
  lookAtWall(kNear_m);
  EXPECT_TRUE(answers([](const CorridorState& verdict) { return verdict.state == CorridorState::BLOCKED; }));
  ASSERT_TRUE(newest_);
  EXPECT_NEAR(newest_->clear_distance, kNear_m, 0.1 + 0.03 * kNear_m);  // a cell, and 3 % of range
}

TEST_F(Cameras, BeforeAFarWallTheCorridorIsFreeAndTheLidarIsUsed) {
  lookAtWall(kFar_m);
  EXPECT_TRUE(answers([](const CorridorState& verdict) {
    return verdict.state == CorridorState::FREE && !(verdict.reasons & CorridorState::NO_LIDAR);
  }));
  ASSERT_TRUE(newest_);
  EXPECT_NEAR(newest_->range_lidar, kFar_m - kLidar_F.x(), 1e-3);
  EXPECT_EQ(newest_->header.frame_id, kind_.left.image_frame);
}

TEST_F(Cameras, InTheNodeletManagerNoImageIsSerialised) {
  if (!kind_.is_raw) GTEST_SKIP() << "its driver is another process";
  XmlRpc::XmlRpcValue name, manager, bus, payload;
  name[0] = ros::this_node::getName();
  name[1] = node_.resolveName("stereo_manager");
  ASSERT_TRUE(ros::master::execute("lookupNode", name, manager, payload, false));
  std::string host;
  std::uint32_t port = 0;
  ASSERT_TRUE(ros::network::splitURI(payload, host, port));
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpc::XmlRpcValue caller;
  caller[0] = ros::this_node::getName();
  ASSERT_TRUE(client.execute("getBusInfo", caller, bus));
  int shared = 0;
  for (int i = 0; i < bus[2].size(); ++i) {  // id, peer, direction, transport, topic, ...
    const std::string topic = bus[2][i][4], transport = bus[2][i][3];
    const bool is_between =
        topic.find("/image_rect") != std::string::npos || topic.find("/image_mono") != std::string::npos;
    if (!is_between) continue;
    EXPECT_EQ(transport, "INTRAPROCESS") << topic;
    ++shared;
  }
  EXPECT_GE(shared, 4) << bus.toXml();
}

}  // namespace
}  // namespace flight_corridor_ros

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "rostest_cameras");
  return RUN_ALL_TESTS();
}
