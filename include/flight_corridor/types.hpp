#pragma once

#include <cstdint>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace flight_corridor {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Broken configuration rules as sentences "section/key: rule (value)"; empty when all hold.
using Violations = std::vector<std::string>;

/// @throws std::invalid_argument with the title and all of them, one a line, unless empty.
void throwIfBroken(const Violations& broken, const std::string& title = "broken configuration");

/// One rectified stereo pair. The images are shared, not copied.
struct StereoFrame {
  double stamp_s = kNaN;  ///< Of both exposures; any clock that the other readings share.
  cv::Mat left;           ///< CV_8UC1, rectified, size of the calibration.
  cv::Mat right;          ///< CV_8UC1, rectified, same size and rows as left.
};

/// One reading of the one-dimensional LiDAR, as the driver sent it.
struct RangeReading {
  double stamp_s = kNaN;
  double range_m = kNaN;           ///< Along the beam. REP-117: -inf too close, +inf nothing in range, NaN erroneous.
  double min_range_m = 0.0;        ///< Nearer readings are refused.
  double max_range_m = kInfinity;  ///< Farther ones mean that nothing is in range.
  double field_of_view_rad = 0.0;  ///< Full width of the beam's cone.
};

}  // namespace flight_corridor
