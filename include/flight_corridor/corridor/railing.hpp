#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "flight_corridor/geometry/fan.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/stereo/window_matcher.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Whether railings may stand in boxes before the wall behind them. Equal bars match at their own disparity, and at one
/// that is smaller by their pitch; if the wall is there, they are matched on it. Then many windows of 5 px by 5 px that
/// were matched on one surface fit in the box as well, all at one common offset, and there are others at the place of
/// the next bar. The same holds for a fence or a net behind the box. But beside these a farther surface shows, and no
/// wall at the distance of the pattern; and no fence's bars are as far apart as those of a near railing would be there.
/// One object, one thread.
class Railings {
 public:
  explicit Railings(const StereoGeometry& geometry);
  ~Railings();

  /// Sets the pair; each of its windows is compared once, whatever the boxes.
  /// @param fan all boxes.  @param depth_m CV_32FC1 of the pair's size, NaN = nothing known.
  /// @param nearest_m nearest depth to search.
  void look(const Fan& fan, const StereoFrame& pair, const cv::Mat& depth_m, double nearest_m);

  /// @param lidar_px disparity of the surface that the LiDAR measured, NaN: none. If nearly all windows are of a
  /// pattern that is matched there, the pattern is there. Between the bars of a railing the beam may pass.
  bool mayBeIn(const Box& box_C, double lidar_px);

 private:
  /// A small window of the left image, and the other disparities at which it fits.
  struct Window;

  const Window& window(int u, int v);
  int wholePixels(double disparity_px) const;

  StereoGeometry geometry_;
  StereoFrame pair_;
  cv::Mat depth_m_;
  cv::Rect view_;    // of all boxes
  int rows_px_ = 1;  // between windows
  int nearest_px_ = 0;
  std::optional<WindowMatcher> matcher_;
  std::vector<Window> windows_;
  std::vector<float> correlations_;
};

}  // namespace flight_corridor
