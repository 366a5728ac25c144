#include "ros/range_serial_diagnostics.hpp"

#include <cmath>
#include <limits>

namespace flight_corridor_ros {

namespace {

using diagnostic_msgs::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kMostRefused = 0.1;  // share of the bytes: a spoilt frame now and then is harmless

}  // namespace

RangeSerialDiagnostics::RangeSerialDiagnostics(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                                               const std::string& port)
    : port_(port),
      newest_{kNaN, kNaN, kNaN},
      updater_(node, private_node, private_node.getNamespace()),
      heartbeat_(1.0, [this] { updater_.force_update(); }) {
  updater_.setHardwareID(port);
  updater_.add("range", this, &RangeSerialDiagnostics::describe);
}

void RangeSerialDiagnostics::recordPort(const std::string& trouble) {
  const std::lock_guard<std::mutex> lock(mutex_);
  openings_ += trouble.empty();
  trouble_ = trouble;
}

void RangeSerialDiagnostics::recordCounts(const flight_corridor::serial::WireCounts& counts) {
  const std::lock_guard<std::mutex> lock(mutex_);
  counts_ = counts;
}

void RangeSerialDiagnostics::recordInvalid(const std::string& cause) {
  const std::lock_guard<std::mutex> lock(mutex_);
  invalid_cause_ = cause;
}

void RangeSerialDiagnostics::recordReading(const flight_corridor::serial::WireReading& reading) {
  const std::lock_guard<std::mutex> lock(mutex_);
  newest_ = reading;
  without_range_ += !std::isfinite(reading.range_m);
}

void RangeSerialDiagnostics::summarise(DiagnosticStatusWrapper& status) const {
  const std::uint64_t bytes = counts_.bytes - described_counts_.bytes;
  const std::uint64_t refused = counts_.refused_bytes - described_counts_.refused_bytes;
  if (!trouble_.empty()) {
    status.summary(DiagnosticStatus::ERROR, "port closed: " + trouble_);
  } else if (bytes == 0) {
    status.summary(DiagnosticStatus::ERROR, "no bytes");
  } else if (counts_.readings == described_counts_.readings) {
    status.summary(DiagnosticStatus::ERROR, "bytes, but no reading: baud, protocol");
  } else if (!invalid_cause_.empty()) {
    status.summary(DiagnosticStatus::WARN, "no reading has a range: " + invalid_cause_);
  } else if (static_cast<double>(refused) > kMostRefused * static_cast<double>(bytes)) {
    status.summary(DiagnosticStatus::WARN, "many bytes refused: wiring, baud");
  } else {
    status.summary(DiagnosticStatus::OK, "readings");
  }
}

void RangeSerialDiagnostics::describe(DiagnosticStatusWrapper& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const ros::WallTime now = ros::WallTime::now();
  summarise(status);
  if (counts_.readings == described_counts_.readings) newest_ = {kNaN, kNaN, kNaN};  // outdated
  status.add("port", port_);
  status.add("port state", trouble_.empty() ? "open" : trouble_);
  status.add("openings", openings_);
  status.add("readings [Hz]",
             static_cast<double>(counts_.readings - described_counts_.readings) / (now - described_).toSec());
  status.add("range [m]", newest_.range_m);
  status.add("strength", newest_.strength);
  status.add("readings", counts_.readings);
  status.add("readings without range", without_range_);
  status.add("bytes", counts_.bytes);
  status.add("bytes refused", counts_.refused_bytes);
  status.add("checksum errors", counts_.checksum_errors);
  described_ = now;
  described_counts_ = counts_;
}

}  // namespace flight_corridor_ros
