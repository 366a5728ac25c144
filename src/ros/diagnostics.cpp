#include "ros/diagnostics.hpp"

#include <utility>

#include "ros/processor.hpp"

namespace flight_corridor_ros {

using diagnostic_msgs::DiagnosticStatus;

Diagnostics::Diagnostics(const ros::NodeHandle& node, const ros::NodeHandle& private_node)
    : updater_(node, private_node, private_node.getNamespace()), heartbeat_(1.0, [this] { update(); }) {
  updater_.setHardwareID("none");
  updater_.add("images", this, &Diagnostics::describeImages);
  updater_.add("LiDAR", this, &Diagnostics::describeLidar);
  updater_.add("corridor", this, &Diagnostics::describeCorridor);
  updater_.add("time", this, &Diagnostics::describeTime);
}

void Diagnostics::countPair() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++pairs_;
}

void Diagnostics::record(const flight_corridor::Report& report, const flight_corridor::Counters& counters,
                         const flight_corridor::MatchingDevice& device, const std::string& attitude_fault,
                         double age_s) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++verdicts_;
  refused_ += isRefusal(report);
  report_ = report;
  counters_ = counters;
  device_ = device;
  attitude_fault_ = attitude_fault;
  age_s_ = age_s;
}

void Diagnostics::update() {
  takeStock();
  updater_.force_update();
}

/// Rates since the last time.
void Diagnostics::takeStock() {
  const std::lock_guard<std::mutex> lock(mutex_);
  const ros::WallTime now = ros::WallTime::now();
  const double elapsed_s = (now - std::exchange(described_, now)).toSec();
  pairs_hz_ = static_cast<double>(pairs_ - std::exchange(described_pairs_, pairs_)) / elapsed_s;
  verdicts_hz_ = static_cast<double>(verdicts_ - std::exchange(described_verdicts_, verdicts_)) / elapsed_s;
  if (verdicts_hz_ > 0.0) return;
  report_ = flight_corridor::Report();  // outdated
  report_.verdict.reasons = flight_corridor::kNoData;
  age_s_ = flight_corridor::kNaN;
}

void Diagnostics::describeImages(Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (pairs_hz_ == 0.0) {
    status.summary(DiagnosticStatus::ERROR, "no stereo pair");
  } else if (isRefusal(report_)) {
    const bool is_askew = report_.rows.fault != flight_corridor::RowFault::None;
    status.summary(DiagnosticStatus::ERROR, "refused: " + flight_corridor::describeReasons(report_.verdict.reasons) +
                                                (is_askew ? ", rows of left and right disagree" : ""));
  } else {
    status.summary(DiagnosticStatus::OK, "stereo pairs come");
  }
  status.add("pairs in [Hz]", pairs_hz_);
  status.add("pairs refused", refused_);
  status.add("rows disagree by [px]", report_.rows.offset_px);
}

/// A LiDAR that was never there is not a fault.
void Diagnostics::describeLidar(Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::uint32_t reasons = report_.verdict.reasons;
  if (counters_.lidar == 0) {
    status.summary(DiagnosticStatus::OK, "no reading so far, stereo answers alone");
  } else if (verdicts_hz_ == 0.0) {
    status.summary(DiagnosticStatus::WARN, "no verdict uses it");
  } else if (reasons & flight_corridor::kNoLidar) {
    status.summary(DiagnosticStatus::WARN, "no usable reading, stereo answers alone");
  } else if (reasons & flight_corridor::kDisagreement) {
    status.summary(DiagnosticStatus::WARN, "disagrees with stereo");
  } else {
    status.summary(DiagnosticStatus::OK, "used");
  }
  status.add("fused range [m]", report_.range.range_m);
  status.add("readings", counters_.lidar);
  status.add("readings invalid", counters_.lidar_invalid);
  status.add("readings gated", counters_.lidar_gated);
  status.add("readings refused by stamp", counters_.refused);
  status.add("stereo ranges gated", counters_.stereo_gated);
}

void Diagnostics::describeCorridor(Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const flight_corridor::Verdict& verdict = report_.verdict;
  const bool answers = verdicts_hz_ > 0.0, knows = verdict.state != flight_corridor::State::Unknown;
  status.summary(!answers ? DiagnosticStatus::ERROR
                 : knows  ? DiagnosticStatus::OK
                          : DiagnosticStatus::WARN,
                 answers ? toString(verdict.state) : "no verdict");
  if (!attitude_fault_.empty()) status.mergeSummary(DiagnosticStatus::WARN, attitude_fault_);
  status.add("reasons", flight_corridor::describeReasons(verdict.reasons));
  status.add("clear distance [m]", verdict.clear_distance_m);
  status.add("scale [-]", report_.scale);
  status.add("scale sigma [-]", report_.scale_sigma);
}

void Diagnostics::describeTime(Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  status.summary(DiagnosticStatus::OK, "of the newest verdict");
  if (!device_.failure.empty()) status.summary(DiagnosticStatus::WARN, "matched on the CPU: " + device_.failure);
  status.add("verdicts out [Hz]", verdicts_hz_);
  status.add("age of the answer [s]", age_s_);
  status.add("matched on", device_.name);
  status.add("stereo [ms]", report_.times.stereo_ms);
  status.add("fusion [ms]", report_.times.fusion_ms);
  status.add("cloud [ms]", report_.times.cloud_ms);
  status.add("map [ms]", report_.times.map_ms);
  status.add("corridor [ms]", report_.times.corridor_ms);
  status.add("total [ms]", report_.times.total_ms);
}

}  // namespace flight_corridor_ros
