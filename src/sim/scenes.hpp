#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/flight.hpp"
#include "sim/glare.hpp"
#include "sim/lidar.hpp"
#include "sim/light.hpp"
#include "sim/rig.hpp"
#include "sim/world.hpp"

namespace flight_corridor::sim {

constexpr double kFirstStamp_s = 100.0;  ///< Of a flight; not zero: that means "no time" to ROS.

/// Everything that a simulated recording is made from.
struct Scene {
  std::vector<Primitive> world;
  Light light;
  std::optional<Sun> sun;                 ///< Absent: not in the image.
  std::optional<DotProjector> projector;  ///< On the rig; absent: none.
  Rig rig;
  LidarModel lidar;
  Flight flight;
};

/// What a stereo pair can see of a family's corridor.
enum class Visibility : std::uint8_t {
  Visible,    ///< Obstacles in the corridor, and the scene beyond a free one.
  Unseeable,  ///< Something is blank, black, glass, a mirror, sky or outshone: FREE is never a claim with evidence.
  TooNear,    ///< Nearer than stereo's blind range at last: no image shows it, a map that remembers holds it.
  Hidden      ///< Neither the camera nor the LiDAR can see that something is there.
};

/// "visible", "unseeable", "too_near" or "hidden".
const char* toString(Visibility visibility);

/// A family of scenes: one name, many seeds.
struct Family {
  std::string name;
  Visibility visibility;
};

/// In alphabetical order.
std::vector<Family> sceneFamilies();

/// Their names, in alphabetical order.
std::vector<std::string> sceneNames();

/// Scenes outside the families: for display, not scored.
std::vector<std::string> shownSceneNames();

/// @param seed varies positions, speeds, textures and exposure.
/// @throws std::invalid_argument naming the unknown scene and the known ones.
Scene makeScene(const std::string& name, std::uint64_t seed);

}  // namespace flight_corridor::sim
