#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "flight_corridor/range/range_fusion.hpp"
#include "sim/lidar.hpp"
#include "sim/random.hpp"

namespace flight_corridor::test_support {

constexpr double kReadings_hz = 100.0;
constexpr double kFrames_hz = 30.0;
constexpr int kFrames = 120;                       // the wall is 2 m away then
constexpr double kStereoDelay_s = 0.1;             // a frame's range comes so late
constexpr double kFocalTimesBaseline_px_m = 42.0;  // the paper's rig
constexpr double kDisparityNoise_px = 0.1;         // of the mean over the beam's footprint
constexpr double kSpeed_mps = 1.5;

/// What stereo alone sees for a frame or two.
struct StereoPeak {
  int from_frame, until_frame;
  double range_m;
};
constexpr StereoPeak kStereoPeaks[] = {{20, 21, 1.5}, {40, 42, 14.0}, {60, 62, 1.0}, {80, 81, 12.0}, {100, 102, 0.8}};

/// A flight at a wall 8 m ahead, and what happens on the beam meanwhile.
struct Approach {
  double appears_s = kInfinity;   ///< An obstacle 3 m ahead comes onto the beam,
  double vanishes_s = kInfinity;  ///< and leaves it.
  bool stereo_peaks = false;
  sim::LidarFault lidar_fault;
};

/// Either a LiDAR reading, or the stereo range of a frame and d_K for it, which is known when the frame was delivered.
struct Sample {
  double stamp_s = kNaN;
  double true_m = kNaN;
  double lidar_m = kNaN;
  double stereo_m = kNaN, fused_m = kNaN, fused_sigma_m = kNaN;
};

inline bool isFrame(const Sample& sample) { return std::isfinite(sample.stereo_m); }

inline double trueRange(const Approach& approach, double time_s) {
  const bool obstacle = approach.appears_s <= time_s && time_s < approach.vanishes_s;
  return obstacle ? 3.0 - kSpeed_mps * (time_s - approach.appears_s) : 8.0 - kSpeed_mps * time_s;
}

inline double stereoSigma(double range_m, double disparity_sigma_px) {
  return range_m * range_m / kFocalTimesBaseline_px_m * disparity_sigma_px;
}

inline double stereoRange(const Approach& approach, int frame, sim::Random& noise) {
  double range_m = trueRange(approach, frame / kFrames_hz);
  for (const StereoPeak& peak : kStereoPeaks) {
    if (approach.stereo_peaks && peak.from_frame <= frame && frame < peak.until_frame) range_m = peak.range_m;
  }
  return range_m + noise.normal(stereoSigma(range_m, kDisparityNoise_px));
}

/// Flies and fuses, each reading when it is delivered.
/// @return samples in the order of their stamps.
inline std::vector<Sample> fly(const Approach& approach, const FusionConfig& config, std::uint64_t seed) {
  sim::Lidar lidar(sim::LidarModel(), approach.lidar_fault, seed);
  sim::Random stereo_noise(seed, sim::Stream::LeftImage);
  RangeFusion fusion(config);
  std::vector<Sample> samples;
  int readings = 0;
  for (int frame = 0; frame <= kFrames; ++frame) {
    const double stamp_s = frame / kFrames_hz;
    for (; readings / kReadings_hz <= stamp_s + kStereoDelay_s; ++readings) {
      const double read_s = readings / kReadings_hz, true_m = trueRange(approach, read_s);
      const double lidar_m = lidar.read(true_m, read_s)->range_m;
      fusion.add(Sensor::Lidar, read_s, lidar_m, config.lidar_variance_m2);
      samples.push_back({read_s, true_m, lidar_m});
    }
    const double stereo_m = stereoRange(approach, frame, stereo_noise);
    const double sigma_m = stereoSigma(stereo_m, config.disparity_sigma_px);
    fusion.add(Sensor::Stereo, stamp_s, stereo_m, config.stereo_variance_m2 + sigma_m * sigma_m);
    const RangeEstimate fused = fusion.at(stamp_s);
    samples.push_back({stamp_s, trueRange(approach, stamp_s), kNaN, stereo_m, fused.range_m, fused.sigma_m});
  }
  std::stable_sort(samples.begin(), samples.end(),
                   [](const Sample& a, const Sample& b) { return a.stamp_s < b.stamp_s; });
  return samples;
}

/// When what is on the beam came there; -inf: it always was.
inline double lastChange(const Approach& approach, double time_s) {
  if (approach.vanishes_s <= time_s) return approach.vanishes_s;
  return approach.appears_s <= time_s ? approach.appears_s : -kInfinity;
}

/// The section fusion of config/paper.yaml.
inline FusionConfig paperSettings() {
  FusionConfig config;
  config.acceleration_sigma_mps2 = 0.0;
  config.lidar_variance_m2 = 0.0005798584;
  config.stereo_variance_m2 = 0.0254800198;
  config.disparity_sigma_px = 0.0;
  config.gate_sigma = kInfinity;
  return config;
}

}  // namespace flight_corridor::test_support
