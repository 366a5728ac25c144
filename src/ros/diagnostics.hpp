#pragma once

#include <diagnostic_updater/diagnostic_updater.h>

#include <mutex>
#include <string>

#include "flight_corridor/pipeline.hpp"
#include "ros/heartbeat.hpp"

namespace flight_corridor_ros {

/// The node's state on /diagnostics, once a second of wall time: "NODE: images", "NODE: LiDAR", "NODE: corridor",
/// "NODE: time". Any thread.
class Diagnostics {
 public:
  Diagnostics(const ros::NodeHandle& node, const ros::NodeHandle& private_node);

  /// A stereo pair came.
  void countPair();
  /// A verdict was published; the counters are the pipeline's, all 0 without one.
  void record(const flight_corridor::Report& report, const flight_corridor::Counters& counters,
              const flight_corridor::MatchingDevice& device, const std::string& attitude_fault, double age_s);

 private:
  using Status = diagnostic_updater::DiagnosticStatusWrapper;

  void update();
  void takeStock();
  void describeImages(Status& status);
  void describeLidar(Status& status);
  void describeCorridor(Status& status);
  void describeTime(Status& status);

  std::mutex mutex_;
  std::uint64_t pairs_ = 0, verdicts_ = 0, refused_ = 0;        // since the node started
  std::uint64_t described_pairs_ = 0, described_verdicts_ = 0;  // up to the last description
  double pairs_hz_ = 0.0, verdicts_hz_ = 0.0;                   // between the last two
  ros::WallTime described_ = ros::WallTime::now();
  flight_corridor::Report report_;
  flight_corridor::Counters counters_;
  flight_corridor::MatchingDevice device_;
  std::string attitude_fault_;
  double age_s_ = flight_corridor::kNaN;
  diagnostic_updater::Updater updater_;
  Heartbeat heartbeat_;
};

}  // namespace flight_corridor_ros
