#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

#include "flight_corridor/band_workers.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/stereo/device_matcher.hpp"
#include "flight_corridor/stereo/disparity_evidence.hpp"
#include "flight_corridor/stereo/patches.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Section `stereo/` of doc/parameters.md: the matcher.
struct StereoConfig {
  int num_disparities_px = 128;
  double min_matched_fraction = 0.08;
  std::string device = "cpu";
};
Violations check(const StereoConfig& config);

/// Throws unless device is "cpu" or "auto", or a DisparityEstimator of small images takes the GPU.
/// @throws std::invalid_argument naming what is missing.
void requireDevice(const StereoConfig& config, const DeviceMatcherFactory& make_device_matcher);

/// The device that matches pairs.
struct MatchingDevice {
  std::string name = "CPU";
  std::string failure;  ///< Why it is the CPU although there is, or should be, a GPU; "": as requested.
};

/// A pair's evidence at each pixel: matches that form patches, and their doubt.
struct Disparity : DisparityEvidence {
  double matched_fraction = 0.0;  ///< Share of pixels with a match [0..1].
};

/// Disparity of rectified pairs, the same on every device: one that does not match a sample of this size as the CPU
/// does is not taken. When a device fails, that pair and all further ones are matched on the CPU. One object, one
/// thread; output buffers are reused.
class DisparityEstimator {
 public:
  /// @param smallest_obstacle_m smaller patches of matches are removed, see Patches.
  /// @param make_device_matcher of config.device "gpu" or "auto"; empty: all pairs are matched on the CPU.
  /// @throws std::invalid_argument with every broken rule, or if the image is too narrow for the search.
  DisparityEstimator(const StereoConfig& config, const StereoGeometry& geometry, double smallest_obstacle_m,
                     const DeviceMatcherFactory& make_device_matcher = {});

  void setSmallestObstacle(double edge_m) { patches_.setSmallestObstacle(edge_m); }

  /// @param covered CV_8UC1, see coveredPixels(): estimate() finds no match there; empty: nothing is covered.
  void setCovered(const cv::Mat& covered) { covered_ = covered; }

  /// @param frame both images CV_8UC1 of geometry.size().
  /// @param out refilled.
  /// @throws std::invalid_argument naming the image that does not fit, and why.
  void estimate(const StereoFrame& frame, Disparity& out);

  /// The same before patches are removed, and also where the view is covered.
  void match(const StereoFrame& frame, DisparityEvidence& out);

  /// Threads for further work on the pair; cv::getNumThreads() at construction.
  BandWorkers& workers() { return workers_; }

  const MatchingDevice& device() const { return device_; }

  /// Nothing nearer is found: it is matched at a smaller disparity, or not at all [m].
  double nearestDepth() const;

 private:
  int num_disparities_;
  StereoGeometry geometry_;
  BandWorkers workers_;
  SemiGlobalMatcher matcher_;
  std::unique_ptr<DeviceMatcher> device_matcher_;  // null: the CPU's
  MatchingDevice device_;
  cv::Mat covered_;
  Patches patches_;
};

}  // namespace flight_corridor
