#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "sim/world.hpp"

namespace flight_corridor::sim {

/// The shadows of a static world: a depth image as seen from the sun (Williams 1978).
class Shadows {
 public:
  /// @param region_W  outside of it nothing is in the shade.
  Shadows(const std::vector<Primitive>& primitives, const Eigen::Vector3d& to_sun_W,
          const Eigen::AlignedBox3d& region_W);

  /// Share of the sun that reaches a point [0..1].
  float lit(const Eigen::Vector3f& p_W) const;

 private:
  void add(const Primitive& primitive);

  Eigen::Isometry3d T_S_W_;  ///< S: z to the sun, origin at the corner of the image; pixel (0, 0) is centred on it.
  cv::Mat height_m_;         ///< CV_32FC1, highest surface along z of S.
};

}  // namespace flight_corridor::sim
