#pragma once

#include <vector>

#include "sim/random.hpp"
#include "sim/scenes.hpp"

namespace flight_corridor::sim {

/// How the scenes of a family are made: adds to a scene that has ground, hills, rig and an unplanned flight.
struct SceneBuilder {
  const char* name;
  Visibility visibility;
  void (*build)(Scene&, Random&);
};

std::vector<SceneBuilder> structureBuilders();  ///< Walls, gaps, ground: large obstacles.
std::vector<SceneBuilder> thinBuilders();       ///< Poles, wires, nets, leaves.
std::vector<SceneBuilder> surfaceBuilders();    ///< Surfaces that one or both sensors cannot see.
std::vector<SceneBuilder> bareBuilders();       ///< Paint on which only the light changes.
std::vector<SceneBuilder> seeingBuilders();     ///< Light, weather, the camera's motion.
std::vector<SceneBuilder> rigBuilders();        ///< Calibrations that are wrong.
std::vector<SceneBuilder> changeBuilders();     ///< Objects that move, appear and vanish.
std::vector<SceneBuilder> placeBuilders();      ///< Forests and houses.
std::vector<SceneBuilder> turnBuilders();       ///< Flights that turn.
std::vector<SceneBuilder> shownBuilders();      ///< For display, not scored.

}  // namespace flight_corridor::sim
