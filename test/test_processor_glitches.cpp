// One faulty message among good ones: the verdicts after it are as without it.

#include <gtest/gtest.h>
#include <tf2_eigen/tf2_eigen.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "support/processor_test.hpp"

namespace flight_corridor_ros {
namespace {

using namespace flight_corridor;
using namespace test_support;

constexpr double kPeriod_s = 0.1;
constexpr int kUntilLearnt = 12, kUntilForgotten = 12;  // pairs; a wrong range stays in doubt for a second
constexpr double kLidarFactor = 0.96;                   // the LiDAR is right, the rig's baseline wrong
constexpr double kAlike = 0.01;                         // of ranges and scale: one reading more or less

/// A rig before a wall, with LiDAR, imu and tf of its own.
class Flight {
 public:
  explicit Flight(const NodeConfig& config) : processor_(config, transforms_, inbox_) {
    mount("range_link", opticalFromForward(), ros::Time());
    mount("imu_link", opticalFromForward(), ros::Time());
    mount("odom", opticalFromForward(), ros::Time());
  }

  void mount(const std::string& frame, const Eigen::Isometry3d& T_C_F, const ros::Time& stamp) {
    geometry_msgs::TransformStamped message = tf2::eigenToTransform(T_C_F);
    message.header.frame_id = "left_optical";
    message.header.stamp = stamp;
    message.child_frame_id = frame;
    transforms_.add(message, stamp.isZero());
  }

  static StereoInputs inputs(double after_s) {
    StereoInputs inputs(kFar_m, 1 + static_cast<std::uint64_t>(std::lround(after_s / 0.01)));
    inputs.stamp(kStart + ros::Duration(after_s));
    inputs.range.range = static_cast<float>(kLidarFactor * kFar_m);
    return inputs;
  }

  static sensor_msgs::Imu imu(double after_s) {
    sensor_msgs::Imu message;
    message.header.frame_id = "imu_link";
    message.header.stamp = kStart + ros::Duration(after_s);
    message.orientation.w = 1.0;
    message.linear_acceleration.z = 9.80665;
    return message;
  }

  void put(const sensor_msgs::Range& range) { inbox_.put(boost::make_shared<const sensor_msgs::Range>(range)); }
  void put(const sensor_msgs::Imu& message) { inbox_.put(boost::make_shared<const sensor_msgs::Imu>(message)); }

  const Report& show(const StereoInputs& pair) {
    return processor_.process({pair.left, boost::make_shared<sensor_msgs::CameraInfo>(pair.left_info), pair.right,
                               boost::make_shared<sensor_msgs::CameraInfo>(pair.right_info)});
  }

  /// A good pair with its readings.
  Report fly(double after_s) {
    for (int i = -9; i <= 0; ++i) put(imu(after_s + 0.01 * i));
    put(inputs(after_s).range);
    return show(inputs(after_s));
  }

 private:
  Transforms transforms_;
  Inbox inbox_;
  Processor processor_;
};

/// A message's fault; it is put between two good pairs.
struct Fault {
  std::string name;
  std::function<void(Flight& flight, double after_s)> put;
};

/// Compares a flight with one in which faults come, one by one.  @param pairs that each may disturb.
void expectForgotten(const std::vector<Fault>& faults, int pairs = 0, const NodeConfig& config = {}) {
  Flight clean(config), faulty(config);
  testing::internal::CaptureStderr();
  int i = 1;
  for (; i <= kUntilLearnt; ++i) clean.fly(kPeriod_s * i), faulty.fly(kPeriod_s * i);
  for (const Fault& fault : faults) {
    fault.put(faulty, kPeriod_s * (i - 0.5));
    for (int last = i + pairs; i < last; ++i) clean.fly(kPeriod_s * i), faulty.fly(kPeriod_s * i);
    const Report expected = clean.fly(kPeriod_s * i), seen = faulty.fly(kPeriod_s * i);
    ++i;
    EXPECT_EQ(toString(seen.verdict.state), toString(expected.verdict.state)) << fault.name;
    EXPECT_EQ(describeReasons(seen.verdict.reasons), describeReasons(expected.verdict.reasons)) << fault.name;
    EXPECT_NEAR(seen.range.range_m, expected.range.range_m, kAlike * kFar_m) << fault.name;
    EXPECT_GT(std::abs(expected.scale - 1.0), 2.0 * kAlike) << "a scale is learnt by then";
    EXPECT_NEAR(seen.scale, expected.scale, kAlike) << fault.name;
    EXPECT_NEAR(seen.scale_sigma, expected.scale_sigma, kAlike) << fault.name;
  }
  testing::internal::GetCapturedStderr();
}

Fault ofPair(const std::string& name, const std::function<void(StereoInputs&)>& spoil) {
  return {name, [name, spoil](Flight& flight, double after_s) {
            StereoInputs inputs = Flight::inputs(after_s);
            spoil(inputs);
            EXPECT_EQ(flight.show(inputs).verdict.state, State::Unknown) << name;
          }};
}

Fault ofRange(const std::string& name, const std::function<void(sensor_msgs::Range&)>& spoil) {
  return {name, [spoil](Flight& flight, double after_s) {
            sensor_msgs::Range range = Flight::inputs(after_s).range;
            spoil(range);
            flight.put(range);
          }};
}

Fault ofTf(const std::string& frame, const Eigen::Isometry3d& T_C_F, bool is_static) {
  return {"tf of " + frame, [=](Flight& flight, double after_s) {
            flight.mount(frame, T_C_F, is_static ? ros::Time() : kStart + ros::Duration(after_s));
          }};
}

TEST(Glitch, OfACameraInfoIsForgottenAtOnce) {
  const std::pair<const char*, std::function<void(sensor_msgs::CameraInfo&)>> kinds[] = {
      {"of zeros", [](auto& info) { info.P.fill(0.0), info.K.fill(0.0); }},
      {"of nothing", [](auto& info) { info = {}; }},
      {"NaN", [](auto& info) { info.P[0] = std::nan(""); }},
      {"of another size", [](auto& info) { info.width /= 2, info.height /= 2; }},
      {"cropped", [](auto& info) { info.roi.x_offset = 10, info.roi.width = 600; }}};
  std::vector<Fault> faults;
  for (const auto& [name, kind] : kinds) {
    const auto& spoil = kind;
    faults.push_back(ofPair(std::string("left ") + name, [spoil](StereoInputs& inputs) { spoil(inputs.left_info); }));
    faults.push_back(ofPair(std::string("right ") + name, [spoil](StereoInputs& inputs) { spoil(inputs.right_info); }));
  }
  faults.push_back(ofPair("both of zeros", [](StereoInputs& inputs) {
    inputs.left_info.P.fill(0.0);
    inputs.right_info.P.fill(0.0);
  }));
  expectForgotten(faults);
}

TEST(Glitch, OfAnImageIsForgottenAtOnce) {
  const std::pair<const char*, std::function<void(sensor_msgs::Image&)>> kinds[] = {
      {"size", [](auto& image) { image.width /= 2, image.height /= 2; }},
      {"encoding", [](auto& image) { image.encoding = "smell8"; }},
      {"length", [](auto& image) { image.data.resize(image.data.size() / 2); }},
      {"nothing", [](auto& image) { image.width = image.height = image.step = 0, image.data.clear(); }}};
  std::vector<Fault> faults;
  for (const auto& [name, kind] : kinds) {
    const auto& spoil = kind;
    faults.push_back(ofPair(std::string("left ") + name, [spoil](StereoInputs& inputs) { spoil(*inputs.left); }));
    faults.push_back(ofPair(std::string("right ") + name, [spoil](StereoInputs& inputs) { spoil(*inputs.right); }));
  }
  faults.push_back(ofPair("no stamp", [](StereoInputs& inputs) { inputs.stamp(ros::Time()); }));
  faults.push_back(ofPair("an old stamp",
                          [](StereoInputs& inputs) { inputs.stamp(inputs.left->header.stamp - ros::Duration(0.5)); }));
  faults.push_back(ofPair("one camera twice", [](StereoInputs& inputs) { inputs.right->data = inputs.left->data; }));
  expectForgotten(faults);
}

TEST(Glitch, OfARangeIsForgottenInASecond) {
  std::vector<Fault> faults;
  for (const float range_m : {0.5f, 1000.0f, NAN, -std::numeric_limits<float>::infinity()}) {
    faults.push_back(ofRange("range " + std::to_string(range_m), [=](auto& range) { range.range = range_m; }));
  }
  expectForgotten(faults, kUntilForgotten);
}

TEST(Glitch, OfARangesHeaderIsForgottenAtOnce) {
  std::vector<Fault> faults;
  for (const char* frame : {"", "range_down", "left_optical"}) {
    faults.push_back(ofRange("range in " + std::string(frame), [=](auto& range) {
      range.header.frame_id = frame;
      range.range = 1.0f;
    }));
  }
  for (const double later_s : {1e6, -99.0, -50.0}) {
    faults.push_back(ofRange("range of another time", [=](auto& range) {
      range.header.stamp += ros::Duration(later_s);
      range.range = 1.0f;
    }));
  }
  faults.push_back(ofRange("range without a stamp", [](auto& range) {
    range.header.stamp = ros::Time();
    range.range = 1.0f;
  }));
  expectForgotten(faults);
}

TEST(Glitch, OfAnImuIsForgottenAtOnce) {
  const std::pair<const char*, std::function<void(sensor_msgs::Imu&)>> kinds[] = {
      {"NaN", [](auto& imu) { imu.linear_acceleration.x = imu.orientation.w = imu.angular_velocity.x = NAN; }},
      {"a blow", [](auto& imu) { imu.linear_acceleration.y = 290.0; }},
      {"impossible", [](auto& imu) { imu.linear_acceleration.y = imu.angular_velocity.x = 1e9; }},
      {"zeros", [](auto& imu) { imu.orientation.w = imu.linear_acceleration.z = 0.0; }},
      {"upside down", [](auto& imu) { imu.orientation.w = 0.0, imu.orientation.x = 1.0; }},
      {"on its side", [](auto& imu) { imu.orientation.w = imu.orientation.x = std::sqrt(0.5); }},
      {"in a frame that tf lacks", [](auto& imu) { imu.header.frame_id = "elsewhere"; }},
      {"in no frame", [](auto& imu) { imu.header.frame_id = ""; }},
      {"without a stamp", [](auto& imu) { imu.header.stamp = ros::Time(); }},
      {"of another time", [](auto& imu) { imu.header.stamp += ros::Duration(1e6); }}};
  std::vector<Fault> faults;
  for (const auto& [name, kind] : kinds) {
    const auto& spoil = kind;
    faults.push_back({std::string("imu ") + name, [spoil](Flight& flight, double after_s) {
                        sensor_msgs::Imu imu = Flight::imu(after_s + 0.001);
                        spoil(imu);
                        flight.put(imu);
                      }});
  }
  NodeConfig level;
  level.core.corridor.level = true;
  level.ros.gravity_frame = "nowhere";
  expectForgotten(faults, 0, level);
  expectForgotten(faults);
}

TEST(Glitch, OfTfIsForgottenAtOnce) {
  Eigen::Isometry3d impossible = opticalFromForward();
  impossible.translation().x() = NAN;
  std::vector<Fault> faults{ofTf("base_link", opticalFromForward(), false)};
  for (const char* frame : {"range_link", "imu_link", "odom", "base_link", ""}) {
    for (const bool is_static : {true, false}) faults.push_back(ofTf(frame, impossible, is_static));
  }
  expectForgotten(faults);
}

}  // namespace
}  // namespace flight_corridor_ros
