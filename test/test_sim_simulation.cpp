#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <set>
#include <stdexcept>

#include "sim/simulation.hpp"

namespace flight_corridor::sim {
namespace {

SimulationOptions small(const std::string& scene, std::uint64_t seed = 0) {
  SimulationOptions options;
  options.scene = scene;
  options.seed = seed;
  options.rate_hz = 10.0;
  options.image_scale = 0.25;
  return options;
}

struct FrameCounts {
  int free = 0, blocked = 0, borderline = 0;
};

/// As scored: borderline frames are those whose answer hangs on 0.10 m.
FrameCounts countFrames(const Simulation& simulation) {
  FrameCounts counts;
  for (std::size_t i = 0; i < simulation.frameTimes().size(); ++i) {
    const CorridorTruth truth = simulation.truth(i);
    if (truth.clear_inflated_m == kInfinity) {
      ++counts.free;
    } else if (truth.clear_exact_m < kInfinity) {
      ++counts.blocked;
    } else {
      ++counts.borderline;
    }
  }
  return counts;
}

bool sameImages(const StereoFrame& a, const StereoFrame& b) {
  return a.stamp_s == b.stamp_s && cv::norm(a.left, b.left, cv::NORM_INF) == 0.0 &&
         cv::norm(a.right, b.right, cv::NORM_INF) == 0.0;
}

std::string messageOf(const SimulationOptions& options) {
  try {
    Simulation simulation(options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Simulation, EachSceneHoldsTheFreeAndBlockedFramesThatItsNamePromises) {
  const std::set<std::string> always_free{"bare_hall", "just_outside", "open_sky", "side_obstacles", "wide_gap"};
  const std::set<std::string> always_blocked{"close_pole"};
  for (const std::string& scene : sceneNames()) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const FrameCounts counts = countFrames(Simulation(small(scene, seed)));
      SCOPED_TRACE(scene + " seed " + std::to_string(seed));
      if (always_blocked.count(scene) != 0) {
        EXPECT_GE(counts.blocked, 20);
        EXPECT_EQ(counts.free + counts.borderline, 0);
      } else if (always_free.count(scene) != 0) {
        EXPECT_GE(counts.free, 20);
        EXPECT_EQ(counts.blocked + counts.borderline, 0);
      } else {
        EXPECT_GE(counts.free, 20);
        EXPECT_GE(counts.blocked, 8);
        EXPECT_LE(counts.borderline, std::max(10, (counts.free + counts.blocked + counts.borderline) / 10));
      }
    }
  }
}

TEST(Simulation, TheLargerBoxIsNeverClearerThanTheSmallerOne) {
  for (const std::string& scene : sceneNames()) {
    const Simulation simulation(small(scene, 3));
    for (std::size_t i = 0; i < simulation.frameTimes().size(); ++i) {
      const CorridorTruth truth = simulation.truth(i);
      constexpr double kTolerance_m = 1e-5;  // of each distance: 1e-6 m of touching and bisection, aslant
      EXPECT_LE(truth.clear_inflated_m, truth.clear_exact_m + kTolerance_m) << scene << " frame " << i;
      EXPECT_LE(truth.clear_exact_m, truth.clear_shrunk_m + kTolerance_m) << scene << " frame " << i;
    }
  }
}

TEST(Simulation, TheSameOptionsGiveTheSameBytesInWhateverOrder) {
  const Simulation once(small("forest", 4)), again(small("forest", 4));
  const StereoFrame frame = once.frame(20);
  again.ranges();
  again.frame(3);
  EXPECT_TRUE(sameImages(frame, again.frame(20)));
  EXPECT_TRUE(sameImages(frame, once.frame(20)));
  const std::vector<RangeReading> ranges = once.ranges(), same_ranges = again.ranges();
  ASSERT_EQ(ranges.size(), same_ranges.size());
  for (std::size_t i = 0; i < ranges.size(); ++i) EXPECT_EQ(ranges[i].range_m, same_ranges[i].range_m);
  EXPECT_EQ(once.imuReadings().back().specific_force_B_mps2, again.imuReadings().back().specific_force_B_mps2);
}

TEST(Simulation, AnotherSeedGivesAnotherFlight) {
  EXPECT_FALSE(sameImages(Simulation(small("wall", 1)).frame(0), Simulation(small("wall", 2)).frame(0)));
}

TEST(Simulation, NoiseDiffersBetweenFramesAndBetweenBothImages) {
  const Simulation simulation(small("blank_wall"));
  const cv::Rect blank(60, 50, 40, 20);
  const StereoFrame first = simulation.frame(60), second = simulation.frame(61);
  EXPECT_GT(cv::norm(first.left(blank), second.left(blank), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(first.left(blank), first.right(blank), cv::NORM_INF), 0.0);
}

TEST(Simulation, FramesAreAsAnnounced) {
  const Simulation simulation(small("pole"));
  EXPECT_NO_THROW(StereoGeometry(simulation.calibration()));
  const StereoFrame frame = simulation.frame(2);
  EXPECT_EQ(frame.left.size(), simulation.calibration().size_px);
  EXPECT_EQ(frame.right.size(), simulation.calibration().size_px);
  EXPECT_EQ(frame.left.type(), CV_8UC1);
  EXPECT_EQ(frame.right.type(), CV_8UC1);
  EXPECT_EQ(frame.stamp_s, simulation.frameTimes()[2]);
  EXPECT_NEAR(simulation.frameTimes()[2] - simulation.frameTimes()[0], 0.2, 1e-9);
  EXPECT_GT(simulation.frameTimes()[0], 0.0);
}

TEST(Simulation, TheBeamEndsOnTheSurfaceThatTheDepthImageShowsThere) {
  const Simulation simulation(small("wall", 6));
  const StereoGeometry geometry(simulation.calibration());
  const Eigen::Isometry3d T_C_L = simulation.T_B_C().inverse() * simulation.T_B_L();
  const std::vector<RangeReading> ranges = simulation.ranges();
  int compared = 0;
  for (std::size_t i = 0; i < simulation.frameTimes().size(); i += 5) {
    const RangeReading& reading = ranges.at(10 * i);  // 100 Hz and 10 Hz
    ASSERT_NEAR(reading.stamp_s, simulation.frameTimes()[i], 1e-6);
    const Eigen::Vector3d p_C = T_C_L * Eigen::Vector3d(reading.range_m, 0, 0);
    const cv::Mat depth_m = simulation.depth(i);
    const Eigen::Vector2d pixel = geometry.project(p_C);
    if (!geometry.contains(pixel)) continue;  // a drop-out
    const float z_m =
        depth_m.at<float>(static_cast<int>(std::lround(pixel.y())), static_cast<int>(std::lround(pixel.x())));
    if (std::abs(z_m - p_C.z()) > 1.0) continue;  // an outlier
    // Noise of 0.02 m, five sigma; half a pixel on a wall that is 0.04 rad aslant is 0.2 mm per metre.
    EXPECT_NEAR(z_m, p_C.z(), 0.1 + 0.002) << i;
    ++compared;
  }
  EXPECT_GE(compared, 12);
}

TEST(Simulation, TheImusReadingsSummedTwiceAreTheFlight) {
  const Simulation simulation(small("wall", 5));
  const std::vector<ImuReading> readings = simulation.imuReadings();
  const double step_s = readings[1].stamp_s - readings[0].stamp_s;
  EXPECT_NEAR(step_s, 0.005, 1e-9);
  const auto p_W = [&](double stamp_s) -> Eigen::Vector3d { return simulation.T_W_B(stamp_s).translation(); };
  Eigen::Vector3d position_W = p_W(readings.front().stamp_s);
  Eigen::Vector3d velocity_W = (position_W - p_W(readings.front().stamp_s - step_s)) / step_s;
  for (const ImuReading& reading : readings) {
    const Eigen::Vector3d acceleration_W =
        simulation.T_W_B(reading.stamp_s).linear() * reading.specific_force_B_mps2 - Eigen::Vector3d(0, 0, 9.80665);
    velocity_W += acceleration_W * step_s;
    position_W += velocity_W * step_s;
  }
  const double duration_s = readings.back().stamp_s - readings.front().stamp_s;
  const Eigen::Vector3d end_W = p_W(readings.back().stamp_s + step_s);
  EXPECT_GT((end_W - p_W(readings.front().stamp_s)).norm(), 4.0);
  // White noise of 0.05 m/s^2, summed twice: variance 0.05^2 * step * duration^3 / 3; five sigma.
  EXPECT_NEAR((position_W - end_W).cwiseAbs().maxCoeff(), 0.0,
              5.0 * 0.05 * std::sqrt(step_s * std::pow(duration_s, 3) / 3.0));
}

TEST(Simulation, TheImusAngularVelocitiesSummedAreTheTurnAndItsAttitudesAreTheFlights) {
  const Simulation simulation(small("weaving", 5));
  const std::vector<ImuReading> readings = simulation.imuReadings();
  const double step_s = readings[1].stamp_s - readings[0].stamp_s;
  Eigen::Quaterniond R_W_B(simulation.T_W_B(readings.front().stamp_s).linear());
  for (std::size_t i = 0; i < readings.size(); ++i) {
    // Noise of 0.003 rad on each axis, five sigma.
    const Eigen::Quaterniond true_R_W_B(simulation.T_W_B(readings[i].stamp_s).linear());
    EXPECT_LT(readings[i].R_W_B.angularDistance(true_R_W_B), 5.0 * 0.003 * std::sqrt(3.0)) << i;
    if (i == 0) continue;
    const Eigen::Vector3d turned =
        0.5 * step_s * (readings[i - 1].angular_velocity_B_rad_s + readings[i].angular_velocity_B_rad_s);
    R_W_B = R_W_B * Eigen::AngleAxisd(turned.norm(), turned.normalized());
  }
  // White noise of 0.005 rad/s: a random walk over 2500 steps; the rule of trapezoids adds less.
  const Eigen::Quaterniond end_R_W_B(simulation.T_W_B(readings.back().stamp_s).linear());
  EXPECT_LT(R_W_B.angularDistance(end_R_W_B),
            5.0 * 0.005 * step_s * std::sqrt(3.0 * static_cast<double>(readings.size())) + 0.002);
}

TEST(Simulation, YawsToAndFroAtTheRateInAnySceneAndItsTruthFollows) {
  const double rate_rad_s = M_PI / 3.0;
  for (const std::string& scene : sceneNames()) {
    SCOPED_TRACE(scene);
    SimulationOptions options = small(scene, 1);
    const Simulation straight(options);
    options.yaw_rate_rad_s = rate_rad_s;
    const Simulation yawing(options);
    ASSERT_EQ(yawing.frameTimes(), straight.frameTimes());
    const auto yaw = [&](double stamp_s) {
      return Eigen::Quaterniond(straight.T_W_B(stamp_s).linear())
          .angularDistance(Eigen::Quaterniond(yawing.T_W_B(stamp_s).linear()));
    };
    int other_truths = 0;
    for (std::size_t i = 0; i < yawing.frameTimes().size(); ++i) {
      const double stamp_s = yawing.frameTimes()[i];
      EXPECT_TRUE(yawing.T_W_B(stamp_s).translation().isApprox(straight.T_W_B(stamp_s).translation()));
      other_truths += yawing.truth(i).clear_exact_m != straight.truth(i).clear_exact_m;
    }
    double fastest_rad_s = 0.0;
    for (double stamp_s = kFirstStamp_s; stamp_s < yawing.frameTimes().back(); stamp_s += 0.005) {
      fastest_rad_s = std::max(fastest_rad_s, std::abs(yaw(stamp_s + 0.005) - yaw(stamp_s)) / 0.005);
    }
    EXPECT_NEAR(fastest_rad_s, rate_rad_s, 0.01 * rate_rad_s);
    EXPECT_NEAR(yaw(yawing.frameTimes().back()), 0.0, 1e-9);
    EXPECT_TRUE(scene == "open_sky" || other_truths > 0);
  }
}

TEST(Simulation, TheImuOfAYawingFlightTurnsAsItsPosesDo) {
  SimulationOptions options = small("wall");
  options.yaw_rate_rad_s = M_PI / 3.0;
  const Simulation simulation(options);
  double largest_rad_s = 0.0;
  for (const ImuReading& reading : simulation.imuReadings()) {
    constexpr double kStep_s = 0.005;
    const Eigen::Matrix3d R_before_after = simulation.T_W_B(reading.stamp_s - kStep_s).linear().transpose() *
                                           simulation.T_W_B(reading.stamp_s + kStep_s).linear();
    const double yaw_rate_rad_s = std::atan2(R_before_after(1, 0), R_before_after(0, 0)) / (2.0 * kStep_s);
    EXPECT_NEAR(reading.angular_velocity_B_rad_s.z(), yaw_rate_rad_s, 6.0 * 0.005);  // its noise
    largest_rad_s = std::max(largest_rad_s, reading.angular_velocity_B_rad_s.z());
  }
  EXPECT_NEAR(largest_rad_s, M_PI / 3.0, 0.2);  // the wobble turns, too
}

TEST(Simulation, GlassIsThereForTheLidarAndNotForTheCamera) {
  const Simulation simulation(small("glass"));
  const cv::Mat depth_m = simulation.depth(0);
  EXPECT_GT(depth_m.at<float>(depth_m.rows / 2, depth_m.cols / 2), 10.0f);
  EXPECT_LT(simulation.ranges().front().range_m, 9.0);
}

TEST(Simulation, AnOverriddenRigErrorChangesTheImagesAndNotTheCalibration) {
  SimulationOptions options = small("wall");
  const Simulation exact(options);
  options.baseline_error = 0.05;
  const Simulation wrong(options);
  EXPECT_EQ(exact.calibration().baseline_m, wrong.calibration().baseline_m);
  EXPECT_EQ(cv::norm(exact.frame(60).left, wrong.frame(60).left, cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(exact.frame(60).right, wrong.frame(60).right, cv::NORM_INF), 0.0);
}

TEST(Simulation, AMovingIntruderCrossesAndAnAppearingBoxVanishes) {
  for (const char* scene : {"intruder", "appear"}) {
    const Simulation simulation(small(scene));
    int changes = 0;
    for (std::size_t i = 1; i < simulation.frameTimes().size(); ++i) {
      changes += (simulation.truth(i).clear_exact_m < kInfinity) != (simulation.truth(i - 1).clear_exact_m < kInfinity);
    }
    EXPECT_EQ(changes, 2) << scene;
  }
}

TEST(Simulation, ALidarFaultLastsAsLongAsAsked) {
  SimulationOptions options = small("wall");
  options.lidar_fault = "zeros";
  options.lidar_fault_from_s = 1.0;
  options.lidar_fault_until_s = 2.0;
  int zeros = 0;
  for (const RangeReading& reading : Simulation(options).ranges()) zeros += reading.range_m == 0.0;
  EXPECT_EQ(zeros, 100);
}

TEST(Simulation, APartOfAFlightIsAsTheWholeFlightBegins) {
  SimulationOptions options = small("forest", 3);
  const Simulation whole(options);
  options.duration_s = 1.05;
  const Simulation part(options);
  ASSERT_EQ(part.frameTimes().size(), 11u);
  EXPECT_TRUE(sameImages(part.frame(10), whole.frame(10)));
  const std::vector<RangeReading> ranges = part.ranges(), all = whole.ranges();
  ASSERT_FALSE(ranges.empty());
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    EXPECT_EQ(ranges[i].stamp_s, all[i].stamp_s);
    EXPECT_EQ(ranges[i].range_m, all[i].range_m);
  }
  EXPECT_NEAR(part.imuReadings().back().stamp_s, part.frameTimes().back(), 0.1);
  options.duration_s = 0.0;
  EXPECT_EQ(Simulation(options).frameTimes().size(), 1u);
  EXPECT_TRUE(Simulation(options).imuReadings().empty());
  options.duration_s = 1000.0;
  EXPECT_EQ(Simulation(options).frameTimes(), whole.frameTimes());
}

TEST(Simulation, RefusesWhatItDoesNotKnowAndNamesWhatItKnows) {
  EXPECT_NE(messageOf(small("volcano")).find("'volcano'; known are: appear"), std::string::npos);
  SimulationOptions options = small("wall");
  options.lidar_fault = "asleep";
  EXPECT_NE(messageOf(options).find("'asleep'; known are: none"), std::string::npos);
  options = small("wall");
  options.rate_hz = 0.0;
  options.duration_s = kNaN;
  options.image_scale = kNaN;
  options.yaw_rate_rad_s = -1.0;
  const std::string message = messageOf(options);
  EXPECT_NE(message.find("rate_hz"), std::string::npos);
  EXPECT_NE(message.find("duration_s"), std::string::npos);
  EXPECT_NE(message.find("image_scale"), std::string::npos);
  EXPECT_NE(message.find("yaw_rate_rad_s"), std::string::npos);
}

}  // namespace
}  // namespace flight_corridor::sim
