#pragma once

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "flight_corridor/corridor/corridor.hpp"
#include "support/temporary_folder.hpp"
#include "tools/replayer.hpp"
#include "tools/stereo_bag_writer.hpp"

namespace flight_corridor::test_support {

using tools::BagRig;
using tools::StereoBagWriter;

inline const ros::Time kWallStart(1603715273, 0);
inline constexpr int kWidth = 160, kHeight = 120;
inline constexpr double kFocal_px = 90.0, kBaseline_m = 0.12;

/// A textured wall, frontal, at the depth of a whole-pixel disparity: both images are one noise texture, shifted.
class WallBagTest : public testing::Test {
 protected:
  WallBagTest() {
    rig.calibration.size_px = {kWidth, kHeight};
    rig.calibration.fx_px = rig.calibration.fy_px = kFocal_px;
    rig.calibration.cx_px = rig.calibration.cx_right_px = 79.5;
    rig.calibration.cy_px = 59.5;
    rig.calibration.baseline_m = kBaseline_m;
    rig.T_B_C = opticalFromForward().inverse();
    cv::RNG random(1);
    random.fill(texture, cv::RNG::UNIFORM, 0, 255);
    config.core.stereo.num_disparities_px = 32;
  }

  std::string path() const { return folder.path("flight.bag"); }
  cv::Mat view(int shift_px) const { return texture.colRange(shift_px, shift_px + kWidth).clone(); }

  /// Six pairs at 10 Hz of a wall at f*B/disparity, and a LiDAR that sees it.
  void writeWall(int disparity_px) const {
    StereoBagWriter bag(path(), rig, kWallStart);
    for (int i = 0; i < 6; ++i) {
      const ros::Time stamp = kWallStart + ros::Duration(0.1 * i);
      RangeReading reading;
      reading.range_m = kFocal_px * kBaseline_m / disparity_px;
      bag.writeRange(stamp, reading);
      bag.writePair(stamp, view(0), view(disparity_px));
    }
    bag.close();
  }

  std::vector<Report> replay(const tools::BagReading& reading = {}) const {
    const tools::StereoBagReader bag(path(), {}, reading);
    std::vector<Report> reports;
    tools::Replayer(bag, config).run([&](const tools::Answer& answer) { reports.push_back(answer.report); });
    return reports;
  }

  test_support::TemporaryFolder folder;
  BagRig rig;
  cv::Mat texture = cv::Mat(kHeight, kWidth + 32, CV_8UC1);
  flight_corridor_ros::NodeConfig config;
};

}  // namespace flight_corridor::test_support
