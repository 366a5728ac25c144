#include "sim/scene_builders.hpp"
#include "sim/scene_parts.hpp"

namespace flight_corridor::sim {
namespace {

void blankWall(Scene& scene, Random& random) { addWallOf(plain(0.55), scene, random); }

/// The pattern repeats; a faint noise on it does not.
void checkerWall(Scene& scene, Random& random) {
  Material material = textured(random, 0.5, 0.04, 0.3);
  material.checker_period_m = 0.4f;
  addWallOf(material, scene, random);
}

void absorbingWall(double grey, Scene& scene, Random& random) {
  Material material = textured(random, grey, 0.35, 0.6);
  material.lidar_return = LidarReturn::Absorbed;
  addWallOf(material, scene, random);
}

/// The LiDAR gets nothing back, the camera sees it well.
void darkWall(Scene& scene, Random& random) { absorbingWall(0.2, scene, random); }

/// The LiDAR gets nothing back, and its texture stays below the camera's noise.
void blackWall(Scene& scene, Random& random) { absorbingWall(0.006, scene, random); }

/// The camera sees through it to a wall behind.
void pane(LidarReturn lidar_return, Scene& scene, Random& random) {
  Material glass = plain(0.5);
  glass.camera_sees = false;
  glass.lidar_return = lidar_return;
  addWallOf(glass, scene, random);
  scene.world.push_back(wallAcross(12.5, -15.0, 15.0, 6.0, masonry(random)));
}

/// The LiDAR ends on it.
void glass(Scene& scene, Random& random) { pane(LidarReturn::Surface, scene, random); }

/// The LiDAR passes it too: nothing on board can know of it.
void glassPassed(Scene& scene, Random& random) { pane(LidarReturn::PassesThrough, scene, random); }

/// Polished steel: the camera sees mostly the trees and the house behind itself, twice as far away as the wall; the
/// LiDAR gets enough back from what is not polished.
void mirror(Scene& scene, Random& random) {
  Material steel = textured(random, 0.4, 0.3, 0.3);
  steel.mirror = static_cast<float>(random.uniform(0.85, 0.95));
  addWallOf(steel, scene, random);
  for (const double side : {-1.0, 1.0}) {
    for (const double x_m : {-4.0, -1.0, 2.5, 5.0}) {
      const double y_m = side * random.uniform(1.5, 4.0);
      scene.world.push_back(uprightPole(x_m, y_m, 0.15, 5.0, bark(random)));
    }
  }
  scene.world.push_back(backdrop(-8.0, masonry(random)));
}

/// High above ground, nothing else: always free, which a blank sky does not show.
void openSky(Scene& scene, Random& random) {
  scene.world.clear();
  addGround(12.0, scene, random);
  scene.flight.start_W.z() = random.uniform(15.0, 25.0);
  flyUntil(scene, 20.0, random.uniform(2.8, 3.2));
}

}  // namespace

std::vector<SceneBuilder> surfaceBuilders() {
  return {{"black_wall", Visibility::Unseeable, blackWall},
          {"blank_wall", Visibility::Unseeable, blankWall},
          {"checker_wall", Visibility::Visible, checkerWall},
          {"dark_wall", Visibility::Visible, darkWall},
          {"glass", Visibility::Unseeable, glass},
          {"glass_passed", Visibility::Hidden, glassPassed},
          {"mirror", Visibility::Unseeable, mirror},
          {"open_sky", Visibility::Unseeable, openSky}};
}

}  // namespace flight_corridor::sim
