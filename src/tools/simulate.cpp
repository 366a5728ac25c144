#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <vector>

#include "sim/simulation.hpp"
#include "tools/command_line.hpp"
#include "tools/csv.hpp"
#include "tools/progress.hpp"
#include "tools/stereo_bag_writer.hpp"

namespace flight_corridor::tools {
namespace {

constexpr double kPoseRate_hz = 100.0;
constexpr std::size_t kFramesAtOnce = 8;  // rendered in parallel, then written in order

std::string lines(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  return text;
}

std::string sceneLines() { return lines(sim::sceneNames()) + lines(sim::shownSceneNames()); }

std::string familyLines() {
  std::string text;
  for (const sim::Family& family : sim::sceneFamilies()) {
    text += family.name + "," + sim::toString(family.visibility) + "\n";
  }
  return text;
}

std::optional<double> numberIfGiven(const CommandLine& options, const std::string& name) {
  if (!options.given(name)) return std::nullopt;
  return options.number(name, -kInfinity);
}

sim::SimulationOptions simulationOptions(const CommandLine& options) {
  sim::SimulationOptions simulation;
  simulation.scene = options.text("scene");
  simulation.seed = static_cast<std::uint64_t>(options.integer("seed", 0));
  simulation.rate_hz = options.number("rate", 1.0);
  simulation.image_scale = options.number("image-scale", 0.1);
  simulation.baseline_error = numberIfGiven(options, "baseline-error");
  simulation.disparity_offset_px = numberIfGiven(options, "disparity-offset");
  simulation.yaw_rate_rad_s = options.number("yaw-rate", 0.0) * M_PI / 180.0;
  simulation.lidar_fault = options.text("lidar-fault");
  return simulation;
}

/// The flight's poses, a little beyond its frames so that every stamp lies between two.
void writePoses(const sim::Simulation& simulation, StereoBagWriter& bag) {
  const std::vector<double>& times_s = simulation.frameTimes();
  const double first_s = times_s.front() - 1.0 / kPoseRate_hz;
  const int count = static_cast<int>((times_s.back() - first_s) * kPoseRate_hz) + 2;
  for (int i = 0; i < count; ++i) {
    const double stamp_s = first_s + i / kPoseRate_hz;
    bag.writePose(ros::Time(stamp_s), simulation.T_W_B(stamp_s));
  }
}

void writeFrames(const sim::Simulation& simulation, StereoBagWriter& bag) {
  const std::size_t count = simulation.frameTimes().size();
  Progress progress("simulate", count);
  std::vector<StereoFrame> frames(kFramesAtOnce);
  for (std::size_t first = 0; first < count; first += kFramesAtOnce) {
    const int now = static_cast<int>(std::min(kFramesAtOnce, count - first));
    cv::parallel_for_({0, now}, [&](const cv::Range& range) {
      for (int i = range.start; i < range.end; ++i) frames[i] = simulation.frame(first + i);
    });
    for (int i = 0; i < now; ++i) {
      bag.writePair(ros::Time(frames[i].stamp_s), frames[i].left, frames[i].right);
      progress.advance();
    }
  }
}

std::vector<TruthRow> truthRows(const sim::Simulation& simulation) {
  std::vector<TruthRow> rows;
  for (std::size_t i = 0; i < simulation.frameTimes().size(); ++i) {
    const sim::CorridorTruth truth = simulation.truth(i);
    rows.push_back(
        {ros::Time(simulation.frameTimes()[i]), truth.clear_exact_m, truth.clear_shrunk_m, truth.clear_inflated_m});
  }
  return rows;
}

int simulate(const CommandLine& options) {
  const sim::Simulation simulation(simulationOptions(options));
  const BagRig rig{simulation.calibration(), simulation.T_B_C(), simulation.T_B_L()};
  StereoBagWriter bag(options.text("out"), rig, ros::Time(simulation.frameTimes().front() - 1.0 / kPoseRate_hz));
  writePoses(simulation, bag);
  const std::vector<RangeReading> ranges = simulation.ranges();
  for (const RangeReading& reading : ranges) bag.writeRange(ros::Time(reading.stamp_s), reading);
  for (const sim::ImuReading& reading : simulation.imuReadings()) {
    bag.writeImu(ros::Time(reading.stamp_s), reading.specific_force_B_mps2,
                 Attitude{reading.R_W_B, reading.angular_velocity_B_rad_s});
  }
  writeFrames(simulation, bag);
  bag.close();
  writeTruth(options.text("truth"), truthRows(simulation));
  std::printf("%s: %zu pairs, %zu ranges\n", options.text("out").c_str(), simulation.frameTimes().size(),
              ranges.size());
  return 0;
}

}  // namespace
}  // namespace flight_corridor::tools

int main(int argc, char** argv) {
  using namespace flight_corridor::tools;
  CommandLine options("simulate", "Simulates a flight of the stereo rig and its LiDAR, with exact truth.");
  options.required("scene", "NAME", "scene to fly through, see --list")
      .required("out", "F.bag", "bag to write")
      .required("truth", "T.csv", "truth of the corridor, a line per stereo pair")
      .optional("seed", "N", "varies positions, speeds, textures and noise", "0")
      .optional("rate", "HZ", "stereo pairs per second", "30")
      .optional("image-scale", "S", "1 = 640x480, 0.5 = 320x240", "1")
      .optional("baseline-error", "E", "(true - announced) / announced baseline; default: the scene's")
      .optional("disparity-offset", "PX", "measured minus true disparity; default: the scene's")
      .optional("yaw-rate", "DEG", "also yaws 25 degrees to and fro on the way, at this many a second at most", "0")
      .optional("lidar-fault", "NAME", "fault of the LiDAR, see --list-lidar-faults", "none")
      .question("list", "print the names of the scenes", sceneLines)
      .question("families",
                "print NAME,KIND of the scenes that are scored: visible, unseeable (FREE has no evidence), too_near "
                "(for stereo) or "
                "hidden (no sensor can see it)",
                familyLines)
      .question("list-lidar-faults", "print the names of the LiDAR's faults",
                [] { return lines(flight_corridor::sim::lidarFaultNames()); })
      .notes("The same options give the same flight.");
  return runTool(options, argc, argv, [&] { return simulate(options); });
}
