#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <vector>

#include "flight_corridor/corridor/free_areas.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "sim/closed_loop.hpp"

namespace flight_corridor::tools {

/// Draws a flight: the camera's image with the judged directions, and the world from above with the way flown so far.
class FlyPictures {
 public:
  /// @param video AVI (motion JPEG) of all pictures; "": none.
  FlyPictures(const sim::ClosedLoop& loop, const std::string& title, const std::string& video, double rate_hz);

  /// @param areas null: a rule without areas.  @param T_W_F of the areas' directions.
  /// @throws std::runtime_error naming the video when it cannot be written.
  void add(const sim::Observation& observation, const sim::Way& way, const AreaGrid* areas,
           const Eigen::Isometry3d& T_W_F);

  /// The last picture, with a line about the outcome.  @throws std::runtime_error naming the file.
  void write(const std::string& path, const std::string& caption);

 private:
  void drawCamera(const sim::Observation& observation, const sim::Way& way, const AreaGrid* areas,
                  const Eigen::Isometry3d& T_W_F);
  void drawFromAbove(const sim::Observation& observation, const sim::Way& way);
  cv::Point pixelAbove(const Eigen::Vector3d& p_W) const;

  const sim::World& world_;
  StereoGeometry geometry_;
  Eigen::Isometry3d T_B_C_;
  std::string title_, video_path_;
  double rate_hz_;
  std::vector<Eigen::Vector3d> trail_W_;
  cv::VideoWriter video_;
  cv::Mat camera_, above_, picture_;
};

}  // namespace flight_corridor::tools
