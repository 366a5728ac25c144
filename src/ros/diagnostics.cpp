#include "ros/diagnostics.hpp"

#include "ros/processor.hpp"

namespace flight_corridor_ros {

using diagnostic_msgs::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;

Diagnostics::Diagnostics(const ros::NodeHandle& node, const ros::NodeHandle& private_node)
    : updater_(node, private_node, private_node.getNamespace()), heartbeat_(1.0, [this] { updater_.force_update(); }) {
  updater_.setHardwareID("none");
  updater_.add("corridor", this, &Diagnostics::describe);
}

void Diagnostics::countPair() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++pairs_;
}

void Diagnostics::record(const flight_corridor::Report& report, const flight_corridor::Counters& counters,
                         double age_s) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++verdicts_;
  refused_ += isRefusal(report);
  report_ = report;
  counters_ = counters;
  age_s_ = age_s;
}

void Diagnostics::describe(DiagnosticStatusWrapper& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool answers = verdicts_ > described_verdicts_;
  if (!answers) {  // what was is no more
    report_ = flight_corridor::Report();
    report_.verdict.reasons = flight_corridor::kNoData;
    age_s_ = flight_corridor::kNaN;
  }
  const flight_corridor::Verdict& verdict = report_.verdict;
  const bool knows = verdict.state != flight_corridor::State::Unknown;
  status.summary(!answers ? DiagnosticStatus::ERROR
                 : knows  ? DiagnosticStatus::OK
                          : DiagnosticStatus::WARN,
                 answers ? toString(verdict.state) : "no verdict");
  status.add("reasons", flight_corridor::describeReasons(verdict.reasons));
  describeRates(status);
  status.add("clear distance [m]", verdict.clear_distance_m);
  status.add("fused range [m]", report_.range.range_m);
  status.add("scale [-]", report_.scale);
  status.add("scale sigma [-]", report_.scale_sigma);
  status.add("pairs refused", refused_);
  status.add("LiDAR readings", counters_.lidar);
  status.add("LiDAR readings invalid", counters_.lidar_invalid);
  status.add("LiDAR readings gated", counters_.lidar_gated);
  status.add("readings refused by stamp", counters_.refused);
  status.add("stereo ranges gated", counters_.stereo_gated);
  status.add("stereo [ms]", report_.times.stereo_ms);
  status.add("fusion [ms]", report_.times.fusion_ms);
  status.add("cloud [ms]", report_.times.cloud_ms);
  status.add("map [ms]", report_.times.map_ms);
  status.add("corridor [ms]", report_.times.corridor_ms);
  status.add("total [ms]", report_.times.total_ms);
}

void Diagnostics::describeRates(DiagnosticStatusWrapper& status) {
  const ros::WallTime now = ros::WallTime::now();
  const double elapsed_s = (now - described_).toSec();
  status.add("pairs in [Hz]", static_cast<double>(pairs_ - described_pairs_) / elapsed_s);
  status.add("verdicts out [Hz]", static_cast<double>(verdicts_ - described_verdicts_) / elapsed_s);
  status.add("age of the answer [s]", age_s_);
  described_ = now;
  described_pairs_ = pairs_;
  described_verdicts_ = verdicts_;
}

}  // namespace flight_corridor_ros
