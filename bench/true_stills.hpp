#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor::bench {

/// A pair with dense truth.
struct TrueStill {
  std::string name;
  StereoFrame frame;
  StereoCalibration calibration;
  cv::Mat truth_px;  ///< CV_32FC1, principal-point difference removed; not finite: none.
  cv::Mat visible;   ///< CV_8UC1, 255: in both views.
};

/// Stills in the folders of a folder, laid out as Middlebury's are in shared/data; none where it is no folder.
std::vector<TrueStill> readStills(const std::filesystem::path& data);

/// A frame from the middle of a flight of each simulated family that stereo can see; the rig is as announced.
std::vector<TrueStill> simulatedStills();

}  // namespace flight_corridor::bench
