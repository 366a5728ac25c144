#pragma once

#include <gtest/gtest.h>

#include <string>

#include "flight_corridor/corridor/corridor.hpp"
#include "support/temporary_folder.hpp"
#include "tools/stereo_bag_writer.hpp"

namespace flight_corridor::test_support {

using tools::BagRig;
using tools::StereoBagWriter;

inline const ros::Time kStart(1603715273, 262142977);

/// Two pairs of tiny images in a bag of their own.
class SmallFlightTest : public testing::Test {
 protected:
  SmallFlightTest() {
    rig.calibration.size_px = {8, 6};
    rig.calibration.fx_px = rig.calibration.fy_px = 10.0;
    rig.calibration.cx_px = 4.0;
    rig.calibration.cy_px = 3.0;
    rig.calibration.cx_right_px = 5.5;
    rig.calibration.baseline_m = 0.12;
    rig.T_B_C = opticalFromForward().inverse();
    rig.T_B_C.translation() = Eigen::Vector3d(0.1, 0.06, 0.02);
    rig.T_B_L.translation() = Eigen::Vector3d(0.12, 0.0, -0.05);
  }

  std::string path() const { return folder.path("flight.bag"); }

  /// Two pairs 0.1 s apart, an imu reading and a range between them, poses around them.
  void writeFlight() const {
    StereoBagWriter bag(path(), rig, kStart);
    Eigen::Isometry3d T_W_B = Eigen::Isometry3d::Identity();
    bag.writePose(kStart, T_W_B);
    T_W_B.translation().x() = 1.0;
    bag.writePose(kStart + ros::Duration(0.2), T_W_B);
    bag.writePair(kStart + ros::Duration(0.1), cv::Mat(6, 8, CV_8UC3, {1, 2, 3}), cv::Mat(6, 8, CV_8UC3, {4, 5, 6}));
    bag.writePair(kStart, cv::Mat(6, 8, CV_8UC1, 10), cv::Mat(6, 8, CV_8UC1, 20));
    bag.writeImu(kStart + ros::Duration(0.03), {0.5, 0.0, 9.75});
    RangeReading reading;
    reading.range_m = -kInfinity;
    reading.max_range_m = 100.0;
    bag.writeRange(kStart + ros::Duration(0.05), reading);
    bag.close();
  }

  TemporaryFolder folder;
  BagRig rig;
};

}  // namespace flight_corridor::test_support
