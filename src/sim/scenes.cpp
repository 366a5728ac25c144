#include "sim/scenes.hpp"

#include <cmath>
#include <map>
#include <stdexcept>

#include "sim/scene_builders.hpp"
#include "sim/scene_parts.hpp"

namespace flight_corridor::sim {
namespace {

const std::map<std::string, SceneBuilder>& builders() {
  static const std::map<std::string, SceneBuilder> kBuilders = [] {
    std::map<std::string, SceneBuilder> by_name;
    for (const auto& kind : {structureBuilders(), thinBuilders(), surfaceBuilders(), bareBuilders(), seeingBuilders(),
                             rigBuilders(), changeBuilders(), placeBuilders(), turnBuilders()}) {
      for (const SceneBuilder& builder : kind) by_name.emplace(builder.name, builder);
    }
    return by_name;
  }();
  return kBuilders;
}

/// Of a family, or of a scene to be looked at.
SceneBuilder builderOf(const std::string& name) {
  if (const auto found = builders().find(name); found != builders().end()) return found->second;
  std::string known;
  for (const std::string& scene : sceneNames()) known += " " + scene;
  for (const SceneBuilder& shown : shownBuilders()) {
    if (shown.name == name) return shown;
    known += std::string(" ") + shown.name;
  }
  throw std::invalid_argument("unknown scene '" + name + "'; known are:" + known);
}

}  // namespace

const char* toString(Visibility visibility) {
  switch (visibility) {
    case Visibility::Visible:
      return "visible";
    case Visibility::Unseeable:
      return "unseeable";
    case Visibility::TooNear:
      return "too_near";
    case Visibility::Hidden:
      return "hidden";
  }
  return "";
}

std::vector<Family> sceneFamilies() {
  std::vector<Family> families;
  for (const auto& [name, builder] : builders()) families.push_back({name, builder.visibility});
  return families;
}

std::vector<std::string> sceneNames() {
  std::vector<std::string> names;
  for (const auto& [name, builder] : builders()) names.push_back(name);
  return names;
}

std::vector<std::string> shownSceneNames() {
  std::vector<std::string> names;
  for (const SceneBuilder& builder : shownBuilders()) names.push_back(builder.name);
  return names;
}

Scene makeScene(const std::string& name, std::uint64_t seed) {
  const SceneBuilder builder = builderOf(name);
  Random random(seed, Stream::Scene);
  Scene scene;
  scene.rig = defaultRig();
  scene.rig.left.gain = random.uniform(210.0, 290.0);  // from 250 the sky is saturated
  scene.rig.right.gain = scene.rig.left.gain * random.uniform(0.93, 1.07);
  scene.rig.right.black_level += random.uniform(-2.0, 2.0);
  scene.flight.phase_rad = random.uniform(0.0, 2.0 * M_PI);
  addGround(1.5, scene, random);
  addSurroundings(scene, random);
  builder.build(scene, random);
  return scene;
}

}  // namespace flight_corridor::sim
