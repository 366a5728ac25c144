// What a rig that is out of calibration does to the verdict, with a LiDAR: right images that are shifted, also without
// one, and focal lengths and baselines that are announced too long or too short.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "sim/simulation.hpp"

namespace {

using namespace flight_corridor;

constexpr double kRate_hz = 4.0;

struct Fault {
  std::string name;
  int shift_px = 0;                    // of the right image to the right: all is matched too far
  double focal = 1.0, baseline = 1.0;  // announced over true
  bool has_lidar = true;
};

std::vector<Fault> faults() {
  std::vector<Fault> faults{{"none"}};
  for (const int shift_px : {-4, -2, -1, 1, 2, 3, 4, 5, 6, 7, 8}) {
    faults.push_back({"shift " + std::to_string(shift_px) + " px", shift_px});
  }
  for (const int shift_px : {1, 3, 6}) {
    faults.push_back({"no LiDAR, " + std::to_string(shift_px) + " px", shift_px, 1.0, 1.0, false});
  }
  for (const double factor : {1.0 / 1.5, 1.0 / 1.2, 1.2, 1.35, 1.5}) {
    char text[32];
    std::snprintf(text, sizeof text, "baseline * %.2f", factor);
    faults.push_back({text, 0, 1.0, factor});
    std::snprintf(text, sizeof text, "focal * %.2f", factor);
    faults.push_back({text, 0, factor, 1.0});
  }
  return faults;
}

/// Over the frames of some flights.
struct Row {
  int blocked = 0, false_free = 0, free = 0, unknown = 0, false_blocked = 0;
  int flights = 0, noticed = 0, longest_frames = 0;  // before a verdict says so, of the flights in which one does
};

struct Run {
  Fault fault;
  std::unique_ptr<Pipeline> pipeline;
  int frames = 0, noticed = -1;  // -1: not yet
};

Run makeRun(const Fault& fault, const sim::Simulation& simulation) {
  StereoCalibration announced = simulation.calibration();
  announced.fx_px *= fault.focal;
  announced.fy_px *= fault.focal;
  announced.baseline_m *= fault.baseline;
  Rig rig;
  rig.T_C_L = simulation.T_B_C().inverse() * simulation.T_B_L();
  return {fault, std::make_unique<Pipeline>(Config(), StereoGeometry(announced), rig)};
}

cv::Mat shifted(const cv::Mat& image, int shift_px) {
  cv::Mat wider;
  cv::copyMakeBorder(image, wider, 0, 0, std::max(0, shift_px), std::max(0, -shift_px), cv::BORDER_REPLICATE);
  return wider.colRange(std::max(0, -shift_px), std::max(0, -shift_px) + image.cols).clone();
}

void fly(const std::string& scene, std::uint64_t seed, std::vector<Row>& rows) {
  sim::SimulationOptions options;
  options.scene = scene;
  options.seed = seed;
  options.rate_hz = kRate_hz;
  const sim::Simulation simulation(options);
  const std::vector<RangeReading> ranges = simulation.ranges();
  std::vector<Run> runs;
  for (const Fault& fault : faults()) runs.push_back(makeRun(fault, simulation));
  auto next = ranges.begin();
  for (std::size_t i = 0; i < simulation.frameTimes().size(); ++i) {
    const StereoFrame frame = simulation.frame(i);
    const sim::CorridorTruth truth = simulation.truth(i);
    const bool blocked = std::isfinite(truth.clear_exact_m), free = !std::isfinite(truth.clear_inflated_m);
    const auto first = next;
    while (next != ranges.end() && next->stamp_s <= frame.stamp_s) ++next;
    for (std::size_t k = 0; k < runs.size(); ++k) {
      Run& run = runs[k];
      for (auto reading = first; run.fault.has_lidar && reading != next; ++reading) run.pipeline->addRange(*reading);
      const Report& report =
          run.pipeline->process({frame.stamp_s, frame.left, shifted(frame.right, run.fault.shift_px)});
      const State state = report.verdict.state;
      rows[k].blocked += blocked;
      rows[k].false_free += blocked && state == State::Free;
      rows[k].free += free;
      rows[k].unknown += free && state == State::Unknown;
      rows[k].false_blocked += free && state == State::Blocked;
      const std::uint32_t reasons = report.verdict.reasons;
      if (run.noticed < 0 && reasons & (kDisagreement | kLidarNearer)) run.noticed = run.frames;
      ++run.frames;
    }
  }
  for (std::size_t k = 0; k < runs.size(); ++k) {
    ++rows[k].flights;
    rows[k].noticed += runs[k].noticed >= 0;
    rows[k].longest_frames = std::max(rows[k].longest_frames, runs[k].noticed);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 3;
  std::vector<std::string> scenes{"wall", "pole", "forest"};
  if (argc > 2) scenes.assign(argv + 2, argv + argc);
  std::vector<Row> rows(faults().size());
  for (const std::string& scene : scenes) {
    for (int seed = 1; seed <= seeds; ++seed) fly(scene, static_cast<std::uint64_t>(seed), rows);
  }
  std::printf(
      "Rigs out of calibration, %.0f Hz, %d seeds; noticed: flights in which LiDAR and stereo disagree, after so many "
      "frames at most.\n",
      kRate_hz, seeds);
  std::printf("%-15s | %7s %5s | %5s %8s %8s | %7s %8s %6s\n", "rig", "blocked", "FREE", "free", "UNKNOWN", "BLOCKED",
              "flights", "noticed", "frames");
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Row& row = rows[k];
    std::printf("%-15s | %7d %5d | %5d %8d %8d | %7d %8d %6d\n", faults()[k].name.c_str(), row.blocked, row.false_free,
                row.free, row.unknown, row.false_blocked, row.flights, row.noticed, row.longest_frames);
  }
}
