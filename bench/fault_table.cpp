// What each LiDAR fault does to the verdict and to the fused range, on flights at a wall, a pole and through a forest.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "sim/simulation.hpp"

namespace {

using namespace flight_corridor;

constexpr double kRate_hz = 10.0;
constexpr double kFrom = 0.35, kUntil = 0.8;  // of the flight: the fault begins before the obstacle is in the corridor
constexpr double kRecovered = 0.05;           // relative difference from the range of the flight without fault
constexpr std::uint32_t kNoticed = kLidarRejected | kNoLidar | kDisagreement;

/// One flight with one fault, frame by frame.
struct Run {
  std::string fault;
  std::vector<RangeReading> ranges;
  std::size_t next_range = 0;
  std::unique_ptr<Pipeline> pipeline;
  std::vector<Report> reports;
};

struct Window {
  double from_s, until_s;
  bool contains(double stamp_s) const { return from_s <= stamp_s && stamp_s < until_s; }
};

/// Of one fault on one flight, or on several of a scene.
struct Row {
  int blocked = 0, false_free = 0, false_blocked = 0;
  std::vector<double> range_errors_m;         // while the fault lasts
  int without_range = 0;                      // frames of that time without d_K
  double notice_s = kNaN, recovery_s = kNaN;  // NaN: never; of several flights the slowest

  void add(const Row& flight) {
    blocked += flight.blocked;
    false_free += flight.false_free;
    false_blocked += flight.false_blocked;
    without_range += flight.without_range;
    range_errors_m.insert(range_errors_m.end(), flight.range_errors_m.begin(), flight.range_errors_m.end());
    const auto slower = [](double a, double b) { return a < b || std::isnan(b) ? b : a; };
    notice_s = slower(notice_s, flight.notice_s);
    recovery_s = slower(recovery_s, flight.recovery_s);
  }
};

sim::SimulationOptions flight(const std::string& scene, std::uint64_t seed) {
  sim::SimulationOptions options;
  options.scene = scene;
  options.seed = seed;
  options.rate_hz = kRate_hz;
  return options;
}

std::vector<Run> makeRuns(const sim::SimulationOptions& options, const Window& window, double start_s) {
  std::vector<Run> runs;
  for (const std::string& fault : sim::lidarFaultNames()) {
    sim::SimulationOptions faulty = options;
    faulty.lidar_fault = fault;
    faulty.lidar_fault_from_s = window.from_s - start_s;
    faulty.lidar_fault_until_s = window.until_s - start_s;
    const sim::Simulation simulation(faulty);
    Rig rig;
    rig.T_C_L = simulation.T_B_C().inverse() * simulation.T_B_L();
    const StereoGeometry geometry(simulation.calibration());
    runs.push_back({fault, simulation.ranges(), 0, std::make_unique<Pipeline>(Config(), geometry, rig), {}});
  }
  return runs;
}

void process(Run& run, const StereoFrame& frame) {
  for (; run.next_range < run.ranges.size() && run.ranges[run.next_range].stamp_s <= frame.stamp_s; ++run.next_range) {
    run.pipeline->addRange(run.ranges[run.next_range]);
  }
  run.reports.push_back(run.pipeline->process(frame));
}

/// @param faultless the same flight without fault: its range is the truth, to the LiDAR's noise.
Row judge(const Run& run, const Run& faultless, const std::vector<sim::CorridorTruth>& truth, const Window& window) {
  Row row;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Report& report = run.reports[i];
    const bool blocked = std::isfinite(truth[i].clear_exact_m), free = !std::isfinite(truth[i].clear_inflated_m);
    row.blocked += blocked;
    row.false_free += blocked && report.verdict.state == State::Free;
    row.false_blocked += free && report.verdict.state == State::Blocked;

    const double stamp_s = report.verdict.stamp_s, expected_m = faultless.reports[i].range.range_m;
    const double error_m = std::abs(report.range.range_m - expected_m);
    const bool suspicious = (report.verdict.reasons & kNoticed) != 0;
    if (window.contains(stamp_s)) {
      if (std::isfinite(error_m)) {
        row.range_errors_m.push_back(error_m);
      } else {
        ++row.without_range;
      }
      if (suspicious && std::isnan(row.notice_s)) row.notice_s = stamp_s - window.from_s;
    }
    const bool recovered = stamp_s >= window.until_s && !suspicious && error_m <= kRecovered * expected_m;
    if (recovered && std::isnan(row.recovery_s)) row.recovery_s = stamp_s - window.until_s;
  }
  return row;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return kNaN;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * (values.size() - 1))];
}

/// One row for each fault.
std::vector<Row> fly(const std::string& scene, std::uint64_t seed) {
  const sim::Simulation simulation(flight(scene, seed));
  const std::vector<double>& times_s = simulation.frameTimes();
  const double duration_s = times_s.back() - times_s.front();
  const Window window{times_s.front() + kFrom * duration_s, times_s.front() + kUntil * duration_s};
  std::vector<Run> runs = makeRuns(flight(scene, seed), window, times_s.front());
  std::vector<sim::CorridorTruth> truth;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const StereoFrame frame = simulation.frame(i);
    truth.push_back(simulation.truth(i));
    for (Run& run : runs) process(run, frame);
  }
  std::vector<Row> rows;
  for (const Run& run : runs) rows.push_back(judge(run, runs.front(), truth, window));
  return rows;
}

void tabulate(const std::string& scene, int seeds) {
  std::vector<Row> rows = fly(scene, 1);
  for (int seed = 2; seed <= seeds; ++seed) {
    const std::vector<Row> flown = fly(scene, static_cast<std::uint64_t>(seed));
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].add(flown[i]);
  }
  const std::vector<std::string> faults = sim::lidarFaultNames();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    std::printf("%-8s %-9s | %7d %10d %13d | %6.3f %6.3f %5d | %6.2f %8.2f\n", scene.c_str(), faults[i].c_str(),
                row.blocked, row.false_free, row.false_blocked, quantile(row.range_errors_m, 0.5),
                quantile(row.range_errors_m, 0.95), row.without_range, row.notice_s, row.recovery_s);
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 3;
  std::printf(
      "LiDAR faults from %.0f %% to %.0f %% of the flight, %.0f Hz, %d seeds; error of d_K against the faultless "
      "flight's while the fault lasts;\nnoticed: rejected, missing, slow or in disagreement; recovered: within %.0f %% "
      "again, nothing suspicious; of the slowest flight; nan: never.\n",
      100 * kFrom, 100 * kUntil, kRate_hz, seeds, 100 * kRecovered);
  std::printf("%-8s %-9s | %7s %10s %13s | %13s %5s | %6s %8s\n", "scene", "fault", "blocked", "false FREE",
              "false BLOCKED", "d_K error [m]", "no", "notice", "recovery");
  std::printf("%-8s %-9s | %7s %10s %13s | %6s %6s %5s | %6s %8s\n", "", "", "frames", "", "", "median", "p95", "d_K",
              "[s]", "[s]");
  for (const char* scene : {"wall", "pole", "forest"}) tabulate(scene, seeds);
}
