#include "sim/still.hpp"

#include "sim/render.hpp"
#include "sim/rig.hpp"
#include "sim/scene_parts.hpp"

namespace flight_corridor::sim {

StereoFrame stillPair(const std::vector<Primitive>& world, std::uint64_t seed) {
  const Rig rig = defaultRig();
  Eigen::Isometry3d T_W_B = Eigen::Isometry3d::Identity();
  T_W_B.translation() = Eigen::Vector3d(0.0, 0.0, kHeight_m) - rig.T_B_C.translation();
  StereoFrame pair;
  pair.stamp_s = 1.0;
  pair.left = expose(render(world, leftCamera(rig, T_W_B)).radiance, rig.left, 2 * seed);
  pair.right = expose(render(world, rightCamera(rig, T_W_B)).radiance, rig.right, 2 * seed + 1);
  return pair;
}

}  // namespace flight_corridor::sim
