#pragma once

#include <diagnostic_updater/diagnostic_updater.h>

#include <cstdint>
#include <mutex>
#include <string>

#include "ros/heartbeat.hpp"
#include "serial/range_parser.hpp"

namespace flight_corridor_ros {

/// range_serial's state on /diagnostics, once a second of wall time. Any thread.
class RangeSerialDiagnostics {
 public:
  RangeSerialDiagnostics(const ros::NodeHandle& node, const ros::NodeHandle& private_node, const std::string& port);

  /// The port's state: "" if open, else the reason why not.
  void recordPort(const std::string& trouble);
  /// The parser's counts so far.
  void recordCounts(const flight_corridor::serial::WireCounts& counts);
  /// Why no reading has had a range for a while; "" while they have.
  void recordInvalid(const std::string& cause);
  void recordReading(const flight_corridor::serial::WireReading& reading);

 private:
  void describe(diagnostic_updater::DiagnosticStatusWrapper& status);
  void summarise(diagnostic_updater::DiagnosticStatusWrapper& status) const;

  const std::string port_;
  std::mutex mutex_;
  std::string trouble_ = "not opened yet", invalid_cause_;
  std::uint64_t openings_ = 0;
  flight_corridor::serial::WireCounts counts_, described_counts_;
  flight_corridor::serial::WireReading newest_;
  std::uint64_t without_range_ = 0;  // readings without a distance
  ros::WallTime described_ = ros::WallTime::now();
  diagnostic_updater::Updater updater_;
  Heartbeat heartbeat_;
};

}  // namespace flight_corridor_ros
