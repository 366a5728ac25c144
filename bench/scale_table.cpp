// Depth error of the cloud before and after scale correction, by two models of the error, for rigs whose calibration is
// wrong in a known way.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <opencv2/core.hpp>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "sim/simulation.hpp"

namespace {

using namespace flight_corridor;

constexpr double kLearning_s = 2.0;  // what the correction may take before it is judged
constexpr std::array<double, 4> kBounds_m{1.0, 2.0, 4.0, 6.0};

struct Fault {
  const char* name;
  double baseline_error, disparity_offset_px;
};
constexpr Fault kFaults[] = {{"none", 0, 0},
                             {"baseline -8 %", -0.08, 0},
                             {"baseline -4 %", -0.04, 0},
                             {"baseline +4 %", 0.04, 0},
                             {"baseline +8 %", 0.08, 0},
                             {"offset -1 px", 0, -1.0},
                             {"offset -0.5 px", 0, -0.5},
                             {"offset +0.5 px", 0, 0.5},
                             {"offset +1 px", 0, 1.0}};

enum Model { kAsItIs, kScaleAlone, kScaleAndOffset };
constexpr std::array<const char*, 3> kModelNames{"as it is", "scale alone", "corrected"};

/// Relative depth errors of matched pixels, by true depth.
using Errors = std::array<std::vector<float>, kBounds_m.size() - 1>;

void collect(const cv::Mat& depth_m, const cv::Mat& truth_m, Errors& errors) {
  for (int v = 0; v < depth_m.rows; v += 3) {
    for (int u = 0; u < depth_m.cols; u += 3) {
      const float truth = truth_m.at<float>(v, u), depth = depth_m.at<float>(v, u);
      for (std::size_t i = 0; i < errors.size(); ++i) {
        if (kBounds_m[i] <= truth && truth < kBounds_m[i + 1] && depth > 0.0f)
          errors[i].push_back(depth / truth - 1.0f);
      }
    }
  }
}

double quantile(std::vector<float>& values, double share) {
  if (values.empty()) return kNaN;
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * (values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

void printErrors(Errors& errors) {
  for (std::vector<float>& error : errors) {
    const double bias = quantile(error, 0.5);
    for (float& e : error) e = std::abs(e);
    std::printf(" %+5.1f %4.1f %4.1f |", 100.0 * bias, 100.0 * quantile(error, 0.5), 100.0 * quantile(error, 0.95));
  }
}

Config configFor(Model model) {
  Config config;
  config.scale.enabled = model != kAsItIs;
  if (model == kScaleAlone) config.scale.offset_prior_sigma_px = 1e-6;
  return config;
}

/// One flight, seen by a pipeline of each model; what they see is added to their errors.
void fly(const Fault& fault, std::uint64_t seed, std::array<Errors, kModelNames.size()>& errors) {
  sim::SimulationOptions options;
  options.scene = "wall";
  options.seed = seed;
  options.rate_hz = 5.0;
  options.baseline_error = fault.baseline_error;
  options.disparity_offset_px = fault.disparity_offset_px;
  const sim::Simulation simulation(options);
  Rig rig;
  rig.T_C_L = simulation.T_B_C().inverse() * simulation.T_B_L();
  std::deque<Pipeline> pipelines;  // they cannot move
  for (const Model model : {kAsItIs, kScaleAlone, kScaleAndOffset}) {
    pipelines.emplace_back(configFor(model), StereoGeometry(simulation.calibration()), rig);
  }
  const std::vector<RangeReading> ranges = simulation.ranges();
  auto next = ranges.begin();
  for (std::size_t i = 0; i < simulation.frameTimes().size(); ++i) {
    const StereoFrame frame = simulation.frame(i);
    for (; next != ranges.end() && next->stamp_s <= frame.stamp_s; ++next) {
      for (Pipeline& pipeline : pipelines) pipeline.addRange(*next);
    }
    const bool judged = frame.stamp_s - simulation.frameTimes().front() >= kLearning_s;
    const cv::Mat truth_m = judged ? simulation.depth(i) : cv::Mat();
    for (std::size_t model = 0; model < pipelines.size(); ++model) {
      pipelines[model].process(frame);
      if (judged) collect(pipelines[model].depth(), truth_m, errors[model]);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 3;
  std::printf(
      "Depth error [%%], median, median and p95 of its amount, by true depth, after %.0f s of learning, %d seeds.\n",
      kLearning_s, seeds);
  std::printf("%-16s %-11s |      1-2 m       |      2-4 m       |      4-6 m       |\n", "rig", "");
  for (const Fault& fault : kFaults) {
    std::array<Errors, kModelNames.size()> errors;
    for (int seed = 1; seed <= seeds; ++seed) fly(fault, static_cast<std::uint64_t>(seed), errors);
    for (std::size_t model = 0; model < errors.size(); ++model) {
      std::printf("%-16s %-11s |", fault.name, kModelNames[model]);
      printErrors(errors[model]);
      std::printf("\n");
    }
    std::fflush(stdout);
  }
}
