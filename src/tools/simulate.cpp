#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <opencv2/core/utility.hpp>
#include <vector>

#include "sim/simulation.hpp"
#include "tools/command_line.hpp"
#include "tools/csv.hpp"
#include "tools/programs.hpp"
#include "tools/progress.hpp"
#include "tools/stereo_bag_writer.hpp"

namespace flight_corridor::tools {
namespace {

constexpr double kPoseRate_hz = 100.0;
constexpr std::size_t kFramesAtOnce = 8;  // rendered in parallel, then written in order

std::vector<std::string> scenes() {
  std::vector<std::string> names = sim::sceneNames();
  for (const std::string& name : sim::shownSceneNames()) names.push_back(name);
  return names;
}

std::vector<std::string> families() {
  std::vector<std::string> lines;
  for (const sim::Family& family : sim::sceneFamilies()) {
    lines.push_back(family.name + "," + sim::toString(family.visibility));
  }
  return lines;
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

void simulate(const sim::SimulationOptions& options, const std::string& bag_path, const std::string& truth_path) {
  const sim::Simulation simulation(options);
  const BagRig rig{simulation.calibration(), simulation.T_B_C(), simulation.T_B_L()};
  StereoBagWriter bag(bag_path, rig, ros::Time(simulation.frameTimes().front() - 1.0 / kPoseRate_hz));
  writePoses(simulation, bag);
  const std::vector<RangeReading> ranges = simulation.ranges();
  for (const RangeReading& reading : ranges) bag.writeRange(ros::Time(reading.stamp_s), reading);
  for (const sim::ImuReading& reading : simulation.imuReadings()) {
    bag.writeImu(ros::Time(reading.stamp_s), reading.specific_force_B_mps2,
                 Attitude{reading.R_W_B, reading.angular_velocity_B_rad_s});
  }
  writeFrames(simulation, bag);
  bag.close();
  writeTruth(truth_path, truthRows(simulation));
  std::printf("%s: %zu pairs, %zu ranges\n", bag_path.c_str(), simulation.frameTimes().size(), ranges.size());
}

}  // namespace
}  // namespace flight_corridor::tools

int flight_corridor::programs::simulate(int argc, char** argv) {
  using namespace tools;
  sim::SimulationOptions options;
  std::string bag, truth;
  CLI::App app("Simulates a flight of the stereo rig and its LiDAR, with exact truth.", "simulate");
  app.add_option("--scene", options.scene, "scene to fly through, see --list")->type_name("NAME")->required();
  app.add_option("--out", bag, "bag to write")->type_name("F.bag")->check(outputFile())->required();
  app.add_option("--truth", truth, "truth of the corridor, a line per stereo pair")
      ->type_name("T.csv")
      ->check(outputFile())
      ->required();
  app.add_option("--seed", options.seed, "varies positions, speeds, textures and noise")
      ->type_name("N")
      ->check(wholeNumber(0, std::numeric_limits<std::uint64_t>::max()));
  app.add_option("--rate", options.rate_hz, "stereo pairs per second")->type_name("HZ")->check(number(1.0));
  app.add_option("--seconds", options.duration_s, "of the flight, from its start on; else all of it")
      ->type_name("S")
      ->default_str("")
      ->check(number(0.0));
  app.add_option("--image-scale", options.image_scale, "1 = 640x480, 0.5 = 320x240")
      ->type_name("S")
      ->check(number(0.1));
  app.add_option("--baseline-error", options.baseline_error,
                 "(true - announced) / announced baseline; else the scene's")
      ->type_name("E")
      ->check(number());
  app.add_option("--disparity-offset", options.disparity_offset_px, "measured minus true disparity; else the scene's")
      ->type_name("PX")
      ->check(number());
  app.add_option_function<double>(
         "--yaw-rate", [&](double rate_deg_s) { options.yaw_rate_rad_s = rate_deg_s * M_PI / 180.0; },
         "also yaws 25 degrees to and fro on the way, at this many a second at most")
      ->type_name("DEG")
      ->default_str("0")
      ->check(number(0.0));
  app.add_option("--lidar-fault", options.lidar_fault, "fault of the LiDAR, see --list-lidar-faults")
      ->type_name("NAME");
  app.add_flag_callback(
      "--list", [] { answer(scenes()); }, "print the names of the scenes");
  app.add_flag_callback(
      "--families", [] { answer(families()); },
      "print NAME,KIND of the scenes that are scored: visible, unseeable\n"
      "(FREE has no evidence), too_near (for stereo) or hidden (no sensor\n"
      "can see it)");
  app.add_flag_callback(
      "--list-lidar-faults", [] { answer(sim::lidarFaultNames()); }, "print the names of the LiDAR's faults");
  app.footer("The same options give the same flight.");
  return runTool(app, argc, argv, [&] { tools::simulate(options, bag, truth); });
}
