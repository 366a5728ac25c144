// How small an obstacle is seen at which distance and where on the grid, how well one close before a wall, one without
// texture, one whose pattern fits on the wall behind it, and a railing: one stereo pair each, no LiDAR.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <opencv2/core/utility.hpp>
#include <string>
#include <utility>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "sim/rig.hpp"
#include "sim/scene_parts.hpp"
#include "sim/still.hpp"

namespace {

using namespace flight_corridor;
using sim::kHalfHeight_m;
using sim::kHalfWidth_m;

constexpr double kCell_m = 0.1;      // of the map; the optical axis is a corner
constexpr double kNearAxis_m = 0.2;  // of the table by places
constexpr double kCorridorEnd_m = 4.0;

using World = std::vector<sim::Primitive>;

/// From dark to bright.
sim::Material anyPaint(sim::Random& random) {
  const double grey = random.uniform(0.15, 0.8), contrast = random.uniform(0.1, 0.35);
  return sim::textured(random, grey, contrast, 0.16);
}

World ballOrBox(double size_m, const Eigen::Vector3d& middle_W, const sim::Material& paint, const sim::Primitive& wall,
                sim::Random& random) {
  return {wall, random.chance(0.5) ? sim::makeSphere(middle_W, size_m / 2.0, paint)
                                   : sim::makeBox(middle_W, Eigen::Vector3d::Constant(size_m), paint)};
}

/// A textured ball or box before a far wall, at some place left and above of the optical axis.
World smallObstacle(double size_m, double distance_m, double left_m, double above_m, sim::Random& random) {
  const sim::Primitive wall = sim::backdrop(random.uniform(5.5, 11.0), sim::masonry(random));
  const sim::Material paint = anyPaint(random);
  return ballOrBox(size_m, {distance_m + size_m / 2.0, left_m, sim::kHeight_m + above_m}, paint, wall, random);
}

/// The whole of it anywhere in the corridor's cross-section.
World anywhere(double size_m, double distance_m, sim::Random& random) {
  const double left_m = random.uniform(-1.0, 1.0) * (kHalfWidth_m - size_m / 2.0);
  const double above_m = random.uniform(-1.0, 1.0) * (kHalfHeight_m - size_m / 2.0);
  return smallObstacle(size_m, distance_m, left_m, above_m, random);
}

/// A coordinate that is a cell's middle or its border, from low to high and either sign.
double onGrid(bool middle, double low_m, double high_m, sim::Random& random) {
  const double shift_m = middle ? kCell_m / 2.0 : 0.0;
  const double index = std::round((random.uniform(low_m, high_m) - shift_m) / kCell_m);
  return random.sign() * std::max(shift_m, kCell_m * index + shift_m);
}

/// Its middle on a corner, an edge or the middle of the cells' cross-sections, near the axis or farther away.
World onCell(double size_m, std::size_t column, sim::Random& random) {
  const std::size_t place = column % 3;  // 0 corner, 1 edge, 2 middle
  const bool turn = random.chance(0.5), is_near = column < 3;
  const double left_m = onGrid(place == 2 || (place == 1 && turn), is_near ? 0.0 : kNearAxis_m,
                               is_near ? kNearAxis_m : kHalfWidth_m - kCell_m, random);
  const double above_m = onGrid(place == 2 || (place == 1 && !turn), 0.0, kHalfHeight_m - kCell_m, random);
  return smallObstacle(size_m, random.uniform(1.0, 3.8), left_m, above_m, random);
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

/// A ball or a box of one grey whose middle is anywhere in the corridor, before a far wall.
World bareObstacle(double size_m, double distance_m, sim::Random& random) {
  constexpr double kContrast = 0.1;
  const sim::Material material = sim::masonry(random);
  double grey = material.grey;
  while (std::abs(grey - material.grey) < kContrast) grey = random.uniform(0.1, 0.85);
  const double left_m = random.uniform(-kHalfWidth_m, kHalfWidth_m);
  const double above_m = random.uniform(-kHalfHeight_m, kHalfHeight_m);
  const sim::Primitive wall = sim::backdrop(random.uniform(5.5, 11.0), material);
  return ballOrBox(size_m, {distance_m + size_m / 2.0, left_m, sim::kHeight_m + above_m}, sim::plain(grey), wall,
                   random);
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

/// Builds the world of a row's size and a column, which is a distance or a number.
using Build = World (*)(double size_m, double column, sim::Random&);

struct Table {
  const char* name;
  const char* title;
  std::vector<double> sizes_m;
  std::vector<double> columns;
  std::vector<std::string> headings;  ///< Of the columns; none: these are distances.
  Build build;

  bool isFree(double column) const { return headings.empty() && column > kCorridorEnd_m; }
};

const std::vector<Table>& tables() {
  static const std::vector<Table> kTables{
      {"places",
       "balls and boxes, anywhere in the corridor, by distance",
       {0.06, 0.08, 0.10, 0.12},
       {1.0, 1.5, 2.0, 2.5, 3.0, 3.4, 3.8},
       {},
       anywhere},
      {"cells",
       "balls and boxes, 1.0 to 3.8 m ahead, by what of the grid's cells their middle is on, and how far beside the "
       "axis",
       {0.06, 0.08, 0.10, 0.12},
       {0, 1, 2, 3, 4, 5},
       {"corner<0.2", "edge<0.2", "middle<0.2", "corner>0.2", "edge>0.2", "middle>0.2"},
       [](double size_m, double column, sim::Random& random) {
         return onCell(size_m, static_cast<std::size_t>(column), random);
       }},
      {"posts",
       "posts, 0.25 to 0.7 m before a wall; the corridor ends at 4 m",
       {0.04, 0.06, 0.08, 0.12},
       {3.9, 3.95, 3.98, 4.12, 4.2},
       {},
       postBeforeWall},
      {"bare",
       "bare balls and boxes, the middle anywhere in the corridor",
       {0.12, 0.16, 0.20, 0.30, 0.40},
       {0.6, 0.8, 1.0, 1.4, 2.0, 3.0},
       {},
       bareObstacle},
      {"boards",
       "striped boards, by height, whose stripes fit on the wall behind the corridor",
       {0.03, 0.06, 0.12, 0.25, 0.5, 20.0},
       {2.0, 2.5, 3.0, 3.6},
       {},
       stripedBoard},
      {"railings",
       "railings, by the pitch of their bars",
       {0.06, 0.08, 0.10, 0.12, 0.15, 0.20},
       {0.8, 1.2, 2.0, 2.5, 3.0, 3.6},
       {},
       railing}};
  return kTables;
}

using Counts = std::array<int, 3>;  // by State

Counts judge(const Table& table, double size_m, double column, int obstacles) {
  static const StereoGeometry kGeometry(sim::defaultRig().calibration);
  std::array<std::atomic<int>, 3> counts{};
  cv::parallel_for_(cv::Range(1, obstacles + 1), [&](const cv::Range& seeds) {
    for (int seed = seeds.start; seed < seeds.end; ++seed) {
      sim::Random random(static_cast<std::uint64_t>(seed), sim::Stream::Scene);
      const World world = table.build(size_m, column, random);
      Pipeline pipeline(Config(), kGeometry, Rig());
      const State state = pipeline.process(sim::stillPair(world, static_cast<std::uint64_t>(seed))).verdict.state;
      ++counts.at(static_cast<std::size_t>(state));
    }
  });
  return {counts[0], counts[1], counts[2]};
}

int of(const Counts& counts, State state) { return counts[static_cast<std::size_t>(state)]; }

void printHeadings(const Table& table) {
  std::printf("  size |");
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.headings.empty()) {
      std::printf("     %.2f m    |", table.columns[i]);
    } else {
      std::printf(" %-13s |", table.headings[i].c_str());
    }
  }
  std::printf("\n");
}

/// A row for each size; in each cell how many are FREE, their share, and how many UNKNOWN.
void print(const Table& table, int obstacles) {
  std::printf("%s, %d each: FREE, their share, UNKNOWN\n", table.title, obstacles);
  printHeadings(table);
  Counts blocked{}, free{};
  for (const double size_m : table.sizes_m) {
    std::printf("%5.2f m|", size_m);
    for (const double column : table.columns) {
      const Counts counts = judge(table, size_m, column, obstacles);
      Counts& sum = table.isFree(column) ? free : blocked;
      for (std::size_t i = 0; i < sum.size(); ++i) sum.at(i) += counts.at(i);
      std::printf(" %3d %4.0f %% %3d |", of(counts, State::Free), 100.0 * of(counts, State::Free) / obstacles,
                  of(counts, State::Unknown));
      std::fflush(stdout);
    }
    std::printf("\n");
  }
  std::printf(
      "total of %s: truly blocked: %d FREE, %d UNKNOWN, %d BLOCKED; truly free: %d FREE, %d UNKNOWN, %d BLOCKED\n\n",
      table.name, of(blocked, State::Free), of(blocked, State::Unknown), of(blocked, State::Blocked),
      of(free, State::Free), of(free, State::Unknown), of(free, State::Blocked));
}

}  // namespace

/// small_things [OBSTACLES [TABLE...]]: so many in each cell; all tables, or those named.
int main(int argc, char** argv) {
  const int obstacles = argc > 1 ? std::atoi(argv[1]) : 20;
  const std::vector<std::string> wanted(argv + std::min(argc, 2), argv + argc);
  for (const Table& table : tables()) {
    if (wanted.empty() || std::count(wanted.begin(), wanted.end(), table.name) > 0) print(table, obstacles);
  }
}
