// How d_K follows the true range on the beam while an obstacle comes and goes or one sensor peaks.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "../test/support/range_trace.hpp"

namespace {

using namespace flight_corridor;
using namespace flight_corridor::test_support;

constexpr int kFlights = 100;         // per case; the first is written
constexpr int kFramesToFollow = 2;    // what a true change may take before d_K is judged
constexpr double kRightShare = 0.05;  // d_K is right when it is so close to the true range
constexpr int kNever = kFrames + 1;

struct Case {
  const char* name;
  Approach approach;
  FusionConfig config;
};

std::vector<Case> cases() {
  Approach both, stereo_peaks, lidar_peaks;
  both.appears_s = 1.51;  // between two frames, as it happens
  both.vanishes_s = 2.51;
  stereo_peaks.stereo_peaks = true;
  lidar_peaks.lidar_fault = {sim::LidarFault::Kind::Spikes, 0.5, kInfinity};  // in flight
  return {{"both", both, {}},
          {"stereo_peaks", stereo_peaks, {}},
          {"lidar_peaks", lidar_peaks, {}},
          {"paper", both, paperSettings()}};
}

/// Over the flights of a case.
struct Score {
  double largest_m = 0.0, squares_m2 = 0.0;
  int frames = 0;
  int until_appeared = 0, until_vanished = 0;  ///< Frames until d_K was right, in the slowest flight.
};

/// @return frames since the change, itself counted, until d_K is right; kNever if it is not before until_s.
int framesUntilRight(const std::vector<Sample>& samples, double change_s, double until_s) {
  int frames = 0;
  for (const Sample& sample : samples) {
    if (!isFrame(sample) || sample.stamp_s < change_s || until_s <= sample.stamp_s) continue;
    ++frames;
    if (std::abs(sample.fused_m - sample.true_m) <= kRightShare * sample.true_m) return frames;
  }
  return kNever;
}

void judge(const Approach& approach, const std::vector<Sample>& samples, Score& score) {
  for (const Sample& sample : samples) {
    const double changed_s = std::max(0.0, lastChange(approach, sample.stamp_s));  // 0: when the flight begins
    const double since_s = sample.stamp_s - changed_s;
    if (!isFrame(sample) || since_s < kFramesToFollow / kFrames_hz) continue;
    const double error_m = std::isnan(sample.fused_m) ? kInfinity : std::abs(sample.fused_m - sample.true_m);
    score.largest_m = std::max(score.largest_m, error_m);
    score.squares_m2 += error_m * error_m;
    ++score.frames;
  }
  const int appeared = framesUntilRight(samples, approach.appears_s, approach.vanishes_s);
  const int vanished = framesUntilRight(samples, approach.vanishes_s, kInfinity);
  score.until_appeared = std::max(score.until_appeared, appeared);
  score.until_vanished = std::max(score.until_vanished, vanished);
}

void write(const std::vector<Sample>& samples, const std::string& path) {
  std::ofstream file(path);
  file << std::fixed << std::setprecision(9)
       << "stamp,range_true_m,range_lidar_m,range_stereo_m,range_fused_m,range_fused_sigma_m\n";
  for (const Sample& sample : samples) {
    file << sample.stamp_s << ',' << sample.true_m << ',' << sample.lidar_m << ',' << sample.stereo_m << ','
         << sample.fused_m << ',' << sample.fused_sigma_m << '\n';
  }
  if (!file.flush()) throw std::runtime_error(path + ": cannot be written");
}

std::string frames(const Approach& approach, int until_right) {
  if (!std::isfinite(approach.appears_s)) return "";
  return until_right == kNever ? "never" : std::to_string(until_right);
}

void print(const Case& flown, const Score& score) {
  std::printf("%-12s | %9.3f | %7.3f | %13s | %13s\n", flown.name, score.largest_m,
              std::sqrt(score.squares_m2 / score.frames), frames(flown.approach, score.until_appeared).c_str(),
              frames(flown.approach, score.until_vanished).c_str());
}

void tabulate(const std::string& folder) {
  std::printf("Error of d_K [m] from %d frames after a change on, and frames until it is within %.0f %%; %d flights.\n",
              kFramesToFollow, 100.0 * kRightShare, kFlights);
  std::printf("%-12s | %9s | %7s | %13s | %13s\n", "case", "largest", "rms", "appears, most", "vanishes, most");
  for (const Case& flown : cases()) {
    Score score;
    for (int seed = 1; seed <= kFlights; ++seed) {
      const std::vector<Sample> samples = fly(flown.approach, flown.config, seed);
      judge(flown.approach, samples, score);
      if (seed == 1) write(samples, folder + "/" + flown.name + ".csv");
    }
    print(flown, score);
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) throw std::runtime_error("usage: range_traces FOLDER");
  tabulate(argv[1]);
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
