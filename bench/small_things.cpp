// How small a thing is seen at which distance: balls and boxes of many paints in the corridor, beside the beam, before
// a wall; one stereo pair each, and no LiDAR.
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "sim/render.hpp"
#include "sim/rig.hpp"
#include "sim/scene_parts.hpp"

namespace {

using namespace flight_corridor;

constexpr std::array<double, 6> kSizes_m{0.06, 0.08, 0.10, 0.12, 0.16, 0.20};
constexpr std::array<double, 4> kDistances_m{2.0, 2.5, 3.0, 3.6};

/// Of the camera at the height of flight, x ahead.
StereoFrame pairOf(double size_m, double distance_m, std::uint64_t seed) {
  sim::Random random(seed, sim::Stream::Scene);
  const sim::Rig rig = sim::defaultRig();
  Eigen::Isometry3d T_W_B = Eigen::Isometry3d::Identity();
  T_W_B.translation().z() = sim::kHeight_m;
  const Eigen::Vector3d camera_W = (T_W_B * rig.T_B_C).translation();
  const double wall_m = random.uniform(5.5, 11.0);
  const double beside_m = random.eitherSign(0.15, 0.45), above_m = random.uniform(-0.1, 0.1);
  const double grey = random.uniform(0.15, 0.8), contrast = random.uniform(0.1, 0.35);
  const sim::Material paint = sim::textured(random, grey, contrast, 0.16);
  const Eigen::Vector3d middle_W = camera_W + Eigen::Vector3d(distance_m + size_m / 2.0, beside_m, above_m);
  const std::vector<sim::Primitive> world{sim::backdrop(camera_W.x() + wall_m, sim::masonry(random)),
                                          random.chance(0.5)
                                              ? sim::makeSphere(middle_W, size_m / 2.0, paint)
                                              : sim::makeBox(middle_W, Eigen::Vector3d::Constant(size_m), paint)};
  StereoFrame pair;
  pair.stamp_s = 1.0;
  pair.left = sim::expose(sim::render(world, sim::leftCamera(rig, T_W_B)).radiance, rig.left, 2 * seed);
  pair.right = sim::expose(sim::render(world, sim::rightCamera(rig, T_W_B)).radiance, rig.right, 2 * seed + 1);
  return pair;
}

}  // namespace

int main(int argc, char** argv) {
  const int things = argc > 1 ? std::atoi(argv[1]) : 20;
  std::printf("Verdicts FREE / UNKNOWN / BLOCKED of %d things each, by size and distance.\n%6s |", things, "size");
  for (const double distance_m : kDistances_m) std::printf("   %.1f m    |", distance_m);
  std::printf("\n");
  const StereoGeometry geometry(sim::defaultRig().calibration);
  for (const double size_m : kSizes_m) {
    std::printf("%.2f m |", size_m);
    for (const double distance_m : kDistances_m) {
      std::array<int, 3> counts{};
      for (int seed = 1; seed <= things; ++seed) {
        Pipeline pipeline(Config(), geometry, Rig());
        const StereoFrame pair = pairOf(size_m, distance_m, static_cast<std::uint64_t>(seed));
        ++counts.at(static_cast<std::size_t>(pipeline.process(pair).verdict.state));
      }
      std::printf(" %2d / %2d / %2d |", counts[static_cast<std::size_t>(State::Free)],
                  counts[static_cast<std::size_t>(State::Unknown)], counts[static_cast<std::size_t>(State::Blocked)]);
      std::fflush(stdout);
    }
    std::printf("\n");
  }
}
