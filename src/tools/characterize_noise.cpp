#include <cmath>
#include <cstdio>
#include <iostream>
#include <limits>
#include <stdexcept>

#include "tools/command_line.hpp"
#include "tools/programs.hpp"
#include "tools/progress.hpp"
#include "tools/replayer.hpp"
#include "tools/score.hpp"
#include "tools/stereo_bag_reader.hpp"

namespace flight_corridor::tools {
namespace {

constexpr std::size_t kFewestSamples = 20;
constexpr double kMaxSlowShare = 0.5;  // a ramp gives 0.89; 20 samples of white noise exceed it once in 1000 times

/// @throws std::runtime_error when the samples do not show the noise of a sensor at rest.
void check(const SampleStatistics& statistics, std::size_t wanted, const std::string& what) {
  if (statistics.count < kFewestSamples) {
    throw std::runtime_error(what + ": only " + std::to_string(statistics.count) + " samples, needs " +
                             std::to_string(kFewestSamples));
  }
  if (statistics.slow_share > kMaxSlowShare) {
    const long percent = std::lround(100.0 * statistics.slow_share);
    throw std::runtime_error(what + ": moves, noise is not to be had from it: " + std::to_string(percent) +
                             " % of its variance lies between the recording's thirds; record at rest");
  }
  if (statistics.count < wanted) {
    std::cerr << "characterize_noise: warning: " << what << ": only " << statistics.count << " of " << wanted
              << " samples\n";
  }
}

void print(const char* key, const SampleStatistics& statistics, const char* what) {
  std::printf("  %s: %.9g  # [m2] of %zu samples of %s, mean %.4f m\n", key, statistics.variance_m2, statistics.count,
              what, statistics.mean_m);
}

/// D_c and d_L of each pair, as many as wanted of each.
struct Samples {
  std::vector<double> stereo_m, lidar_m;
};

Samples collect(const StereoBagReader& bag, const flight_corridor_ros::NodeConfig& config, std::size_t wanted) {
  Samples samples;
  const auto keep = [wanted](double range_m, std::vector<double>& kept_m) {
    if (std::isfinite(range_m) && kept_m.size() < wanted) kept_m.push_back(range_m);
  };
  Progress progress("characterize_noise", bag.leftImages());
  Replayer(bag, config).run([&](const Answer& answer) {
    keep(answer.report.range_stereo_m, samples.stereo_m);
    keep(answer.report.range_lidar_m, samples.lidar_m);
    progress.advance();
  });
  return samples;
}

void characterizeNoise(const ReplayInput& input, std::size_t wanted) {
  flight_corridor_ros::NodeConfig config = readConfig(input.config, input.overrides);
  config.core.scale.enabled = false;          // it would pull D_c to d_L
  config.core.fusion.gate_sigma = kInfinity;  // it would refuse the noise's tails
  const StereoBagReader bag(input.bag, input.topics, input.reading);
  std::fprintf(stderr, "characterize_noise: %s\n", bag.describe().c_str());
  const Samples samples = collect(bag, config, wanted);
  const SampleStatistics stereo = statistics(samples.stereo_m), lidar = statistics(samples.lidar_m);
  check(stereo, wanted, input.bag + ": D_c");
  if (bag.hasRanges()) check(lidar, wanted, input.bag + ": d_L");

  std::printf("fusion:\n");
  if (bag.hasRanges()) print("lidar_variance_m2", lidar, "d_L");
  print("stereo_variance_m2", stereo, "D_c");
}

}  // namespace
}  // namespace flight_corridor::tools

int flight_corridor::programs::characterize_noise(int argc, char** argv) {
  using namespace tools;
  ReplayInput input;
  std::size_t samples = 150;
  CLI::App app("Measures the noise of both ranges from a bag in which nothing moves.", "characterize_noise");
  addOptions(app, input);
  app.add_option("--samples", samples, "samples to use of each range")
      ->type_name("N")
      ->check(wholeNumber(kFewestSamples, std::numeric_limits<std::size_t>::max()));
  app.footer(
      "Prints the sample variances (n - 1) of the LiDAR's range d_L and the stereo range D_c as YAML for the\n"
      "configuration, with scale correction switched off; refuses recordings that moved. stereo_variance_m2 adds to "
      "what\ndisparity_sigma_px gives.");
  return runTool(app, argc, argv, [&] { tools::characterizeNoise(input, samples); });
}
