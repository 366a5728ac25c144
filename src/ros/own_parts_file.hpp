#pragma once

#include <string>

#include "flight_corridor/stereo/own_parts.hpp"

namespace flight_corridor_ros {

/// The UAV's own parts from the image file of `stereo/mask`: dark is covered, bright is view.
/// @param path "": there are none.  @param scale of the images that are processed, `ros/scale`; a pixel is covered if
/// any of those that become it is.
/// @throws std::invalid_argument naming a file that is no readable image.
flight_corridor::OwnParts readOwnParts(const std::string& path, double scale);

}  // namespace flight_corridor_ros
