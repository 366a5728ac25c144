// How small an obstacle is seen at which distance, how well one close before a wall, one without texture, one whose
// pattern fits on the wall behind it, and a railing: one stereo pair each, no LiDAR.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "sim/rig.hpp"
#include "sim/scene_parts.hpp"
#include "sim/still.hpp"

namespace {

using namespace flight_corridor;

constexpr std::array<double, 6> kSizes_m{0.06, 0.08, 0.10, 0.12, 0.16, 0.20};
constexpr std::array<double, 4> kDistances_m{2.0, 2.5, 3.0, 3.6};
constexpr std::array<double, 4> kWidths_m{0.04, 0.06, 0.08, 0.12};
constexpr std::array<double, 5> kPostDistances_m{3.9, 3.95, 3.98, 4.12, 4.2};
constexpr std::array<double, 5> kBareSizes_m{0.12, 0.16, 0.20, 0.30, 0.40};
constexpr std::array<double, 5> kBareDistances_m{0.8, 1.0, 1.4, 2.0, 3.0};
constexpr std::array<double, 6> kHeights_m{0.03, 0.06, 0.12, 0.25, 0.5, 20.0};
constexpr std::array<double, 6> kPitches_m{0.06, 0.08, 0.10, 0.12, 0.15, 0.20};
constexpr std::array<double, 6> kRailingDistances_m{0.8, 1.2, 2.0, 2.5, 3.0, 3.6};

using World = std::vector<sim::Primitive>;

/// From dark to bright.
sim::Material anyPaint(sim::Random& random) {
  const double grey = random.uniform(0.15, 0.8), contrast = random.uniform(0.1, 0.35);
  return sim::textured(random, grey, contrast, 0.16);
}

/// A ball or a box in the corridor, beside the beam, before a far wall.
World smallObstacle(double size_m, double distance_m, sim::Random& random) {
  const double wall_m = random.uniform(5.5, 11.0);
  const double beside_m = random.eitherSign(0.15, 0.45), above_m = random.uniform(-0.1, 0.1);
  const sim::Material paint = anyPaint(random);
  const Eigen::Vector3d middle_W(distance_m + size_m / 2.0, beside_m, sim::kHeight_m + above_m);
  return {sim::backdrop(wall_m, sim::masonry(random)),
          random.chance(0.5) ? sim::makeSphere(middle_W, size_m / 2.0, paint)
                             : sim::makeBox(middle_W, Eigen::Vector3d::Constant(size_m), paint)};
}

/// A round or a square post in the corridor, beside the beam, before a wall beyond the corridor's end.
World postBeforeWall(double width_m, double distance_m, sim::Random& random) {
  const double wall_m = distance_m + random.uniform(0.25, 0.7);
  const double beside_m = random.eitherSign(0.1, 0.5);
  const sim::Material paint = anyPaint(random);
  const double middle_m = distance_m + width_m / 2.0;
  return {sim::backdrop(wall_m, sim::masonry(random)),
          random.chance(0.5) ? sim::uprightPole(middle_m, beside_m, width_m / 2.0, 4.0, paint)
                             : sim::makeBox({middle_m, beside_m, 2.0}, {width_m, width_m, 4.0}, paint)};
}

/// A ball or a box of one grey, of which 8 cm are in the corridor, from the left or right, before a far wall.
World bareObstacle(double size_m, double distance_m, sim::Random& random) {
  constexpr double kHalfWidth_m = 0.6, kInside_m = 0.08, kContrast = 0.1;
  const sim::Material wall = sim::masonry(random);
  double grey = wall.grey;
  while (std::abs(grey - wall.grey) < kContrast) grey = random.uniform(0.1, 0.85);
  const double side_m = random.sign() * (kHalfWidth_m - kInside_m + size_m / 2.0);
  const Eigen::Vector3d middle_W(distance_m + size_m / 2.0, side_m, sim::kHeight_m + random.uniform(-0.1, 0.1));
  const sim::Material paint = sim::plain(grey);
  return {sim::backdrop(random.uniform(5.5, 11.0), wall),
          random.chance(0.5) ? sim::makeSphere(middle_W, size_m / 2.0, paint)
                             : sim::makeBox(middle_W, Eigen::Vector3d::Constant(size_m), paint)};
}

/// A board of upright stripes without end in the corridor, before a far wall. As many of their periods as one, two or
/// three are what the disparities differ by: each stripe fits on the wall's.
World stripedBoard(double height_m, double distance_m, sim::Random& random) {
  const double wall_m = random.uniform(4.5, 8.0), periods = std::floor(random.uniform(1.0, 4.0));
  const double period_m = sim::defaultRig().calibration.baseline_m * (1.0 - distance_m / wall_m) / periods;
  const double middle_m = sim::kHeight_m + random.uniform(-0.1, 0.1);
  const sim::Material dark = sim::plain(random.uniform(0.1, 0.3)), bright = sim::plain(random.uniform(0.5, 0.85));
  World world{sim::backdrop(wall_m, sim::masonry(random))};
  const int half = static_cast<int>(2.0 * distance_m / period_m);
  for (int i = -half; i <= half; ++i) {
    for (const auto& [paint, at] : {std::pair(dark, i - 0.25), std::pair(bright, i + 0.25)}) {
      world.push_back(
          sim::makeBox({distance_m + 0.01, at * period_m, middle_m}, {0.02, period_m / 2.0, height_m}, paint));
    }
  }
  return world;
}

/// Equal bars across the view and two rails above and below the corridor, before a wall.
World railing(double pitch_m, double distance_m, sim::Random& random) {
  const double wall_m = random.uniform(4.5, 10.0), bar_m = random.uniform(0.012, 0.025);
  const double first_m = random.uniform(-4.0 - pitch_m, -4.0);
  const sim::Material paint = anyPaint(random);
  World world{sim::backdrop(wall_m, sim::masonry(random))};
  for (double at_m = first_m; at_m < 4.0; at_m += pitch_m) {
    world.push_back(sim::makeBox({distance_m + 0.01, at_m, sim::kHeight_m}, {0.02, bar_m, 1.0}, paint));
  }
  for (const double above_m : {-0.5, 0.5}) {
    world.push_back(sim::makeBox({distance_m + 0.02, 0.0, sim::kHeight_m + above_m}, {0.04, 8.0, 0.04}, paint));
  }
  return world;
}

/// A row for each size, a column for each distance.
template <class Sizes, class Distances, class Build>
void printVerdicts(const char* title, const Sizes& sizes_m, const Distances& distances_m, int obstacles,
                   const Build& build) {
  std::printf("FREE / UNKNOWN / BLOCKED of %d %s\n%6s |", obstacles, title, "size");
  for (const double distance_m : distances_m) std::printf("   %.2f m   |", distance_m);
  std::printf("\n");
  const StereoGeometry geometry(sim::defaultRig().calibration);
  for (const double size_m : sizes_m) {
    std::printf("%.2f m |", size_m);
    for (const double distance_m : distances_m) {
      std::array<int, 3> counts{};
      for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(obstacles); ++seed) {
        sim::Random random(seed, sim::Stream::Scene);
        const StereoFrame pair = sim::stillPair(build(size_m, distance_m, random), seed);
        Pipeline pipeline(Config(), geometry, Rig());
        ++counts.at(static_cast<std::size_t>(pipeline.process(pair).verdict.state));
      }
      std::printf(" %2d / %2d / %2d |", counts[static_cast<std::size_t>(State::Free)],
                  counts[static_cast<std::size_t>(State::Unknown)], counts[static_cast<std::size_t>(State::Blocked)]);
      std::fflush(stdout);
    }
    std::printf("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int obstacles = argc > 1 ? std::atoi(argv[1]) : 20;
  printVerdicts("balls and boxes each", kSizes_m, kDistances_m, obstacles, smallObstacle);
  std::printf("\n");
  printVerdicts("posts each, 0.25 to 0.7 m before a wall (the corridor ends at 4 m)", kWidths_m, kPostDistances_m,
                obstacles, postBeforeWall);
  std::printf("\n");
  printVerdicts("bare balls and boxes each, 8 cm of them in the corridor", kBareSizes_m, kBareDistances_m, obstacles,
                bareObstacle);
  std::printf("\n");
  printVerdicts("striped boards each, by height, whose stripes fit on the wall behind the corridor", kHeights_m,
                kDistances_m, obstacles, stripedBoard);
  std::printf("\n");
  printVerdicts("railings each, by the pitch of their bars", kPitches_m, kRailingDistances_m, obstacles, railing);
}
