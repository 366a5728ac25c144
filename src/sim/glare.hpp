#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "sim/render.hpp"
#include "sim/world.hpp"

namespace flight_corridor::sim {

/// The sun as a lens spreads it over the image.
struct Sun {
  Eigen::Vector3d to_sun_W = Eigen::Vector3d::UnitX();  ///< Unit.
  double saturated_rad = 0.1;  ///< Angle from the sun within which its stray light alone is white (radiance 1).
};

/// Adds the sun's stray light to an image, unless something that the camera sees stands before the sun.
/// Model: radiance = (saturated_rad / angle to the sun)^2. Source: Stiles and Holladay's disability glare, CIE 146
/// (2002).
/// @param radiance CV_32FC1, size = camera.size_px; changed in place.
void addGlare(const Sun& sun, const std::vector<Primitive>& primitives, const Camera& camera, cv::Mat& radiance);

}  // namespace flight_corridor::sim
