#include "sim/scene_builders.hpp"
#include "sim/scene_parts.hpp"

namespace flight_corridor::sim {
namespace {

/// All at once, each a little.
void miscalibrated(Scene& scene, Random& random) {
  addWall(scene, random);
  scene.rig.baseline_error = random.eitherSign(0.03, 0.06);
  scene.rig.disparity_offset_px = random.eitherSign(0.2, 0.5);
  scene.rig.vertical_shift_px = random.uniform(-0.2, 0.2);
}

/// The true baseline is 3 to 8 % longer or shorter than announced.
void scaleError(Scene& scene, Random& random) {
  addWall(scene, random);
  scene.rig.baseline_error = random.eitherSign(0.03, 0.08);
}

/// The right camera is yawed by up to 0.15 degrees: 0.4 to 0.9 px.
void disparityOffset(Scene& scene, Random& random) {
  addWall(scene, random);
  scene.rig.disparity_offset_px = random.eitherSign(0.4, 0.9);
}

/// The right image is up to 0.7 px too high or too low.
void rowShift(Scene& scene, Random& random) {
  addWall(scene, random);
  scene.rig.vertical_shift_px = random.eitherSign(0.3, 0.7);
}

}  // namespace

std::vector<SceneBuilder> rigBuilders() {
  return {{"disparity_offset", Visibility::Visible, disparityOffset},
          {"miscalibrated", Visibility::Visible, miscalibrated},
          {"row_shift", Visibility::Visible, rowShift},
          {"scale_error", Visibility::Visible, scaleError}};
}

}  // namespace flight_corridor::sim
