#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"
#include "sim/imu.hpp"
#include "sim/scenes.hpp"
#include "sim/truth.hpp"

namespace flight_corridor::sim {

struct SimulationOptions {
  std::string scene;                          ///< One of sceneNames().
  std::uint64_t seed = 0;                     ///< Varies positions, speeds, textures and noise.
  double rate_hz = 30.0;                      ///< Of the stereo pairs.
  double duration_s = kInfinity;              ///< What is recorded of the flight, from its start on; at most all of it.
  double image_scale = 1.0;                   ///< 1 = 640x480; 0.5 = 320x240, same field of view.
  std::optional<double> baseline_error;       ///< (true - announced) / announced baseline [-]; absent: the scene's.
  std::optional<double> disparity_offset_px;  ///< Measured minus true disparity; absent: the scene's.
  double yaw_rate_rad_s = 0.0;                ///< 0: as the scene flies; else it also yaws to and fro, so fast at most.
  std::string lidar_fault = "none";           ///< One of lidarFaultNames().
  double lidar_fault_from_s = 0.0;            ///< After the flight's start.
  double lidar_fault_until_s = kInfinity;     ///< After the flight's start.
  Eigen::Vector3d corridor_m{4.0, 1.2, 0.4};  ///< Length, width and height of the box that truth() speaks of.
};

/// One recorded flight: stereo pairs, LiDAR and imu readings, poses and truth, computed on demand. The same options
/// give the same bytes, in any order of calls.
class Simulation {
 public:
  /// @throws std::invalid_argument naming unknown names or impossible values, and the known names.
  explicit Simulation(const SimulationOptions& options);

  /// The announced calibration; the truth may differ.
  const StereoCalibration& calibration() const { return scene_.rig.calibration; }
  Eigen::Isometry3d T_B_C() const { return scene_.rig.T_B_C; }
  Eigen::Isometry3d T_B_L() const { return scene_.rig.T_B_L; }
  /// True pose of the body at a stamp; before the first and after the last one the body stands still.
  Eigen::Isometry3d T_W_B(double stamp_s) const;

  /// Stamps of the stereo pairs [s], ascending.
  const std::vector<double>& frameTimes() const { return frame_times_s_; }
  StereoFrame frame(std::size_t index) const;
  /// All LiDAR readings of the flight, ascending stamps.
  std::vector<RangeReading> ranges() const;
  /// All imu readings of the flight, ascending stamps, from the second to the last but one moment: before the start and
  /// after the end nobody moves.
  std::vector<ImuReading> imuReadings() const;
  CorridorTruth truth(std::size_t index) const;
  /// Exact depth of the left image [m], CV_32FC1, NaN = sky.
  cv::Mat depth(std::size_t index) const;

 private:
  std::vector<Primitive> worldAt(double stamp_s) const;

  SimulationOptions options_;
  Scene scene_;
  LidarFault lidar_fault_;
  double duration_s_;
  std::vector<double> frame_times_s_;
};

}  // namespace flight_corridor::sim
