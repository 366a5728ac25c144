// The free areas against a query of each direction's box, over all families of simulated flights, and what they cost.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "sim/simulation.hpp"

namespace {

using namespace flight_corridor;
using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct Family {
  int frames = 0;
  double pair_ms = 0.0, areas_ms = 0.0;  // sums
  int free = 0, blocked = 0, unknown = 0, same = 0, wrong_free = 0;

  void count(const Verdict& area, const Verdict& asked) {
    free += area.state == State::Free;
    blocked += area.state == State::Blocked;
    unknown += area.state == State::Unknown;
    same += area.state == asked.state;
    wrong_free += area.state == State::Free && asked.state == State::Blocked;
  }
};

void fly(const std::string& scene, std::uint64_t seed, Family& family) {
  sim::SimulationOptions options;
  options.scene = scene;
  options.seed = seed;
  options.rate_hz = 1.0;
  const sim::Simulation simulation(options);
  Rig rig;
  rig.T_C_L = simulation.T_B_C().inverse() * simulation.T_B_L();
  Pipeline pipeline(Config(), StereoGeometry(simulation.calibration()), rig);
  const std::vector<RangeReading> ranges = simulation.ranges();
  std::size_t next = 0;
  for (std::size_t i = 0; i < simulation.frameTimes().size(); ++i) {
    const StereoFrame pair = simulation.frame(i);
    while (next < ranges.size() && ranges[next].stamp_s <= pair.stamp_s) pipeline.addRange(ranges[next++]);
    Clock::time_point start = Clock::now();
    pipeline.process(pair);
    family.pair_ms += millisecondsSince(start);
    start = Clock::now();
    const AreaGrid grid = pipeline.freeAreas();
    family.areas_ms += millisecondsSince(start);
    ++family.frames;
    for (const FreeArea& area : grid.areas) {
      Box box = pipeline.boxInCamera();
      box.T_M_F.rotate(Eigen::AngleAxisd(area.yaw_rad, Eigen::Vector3d::UnitZ()) *
                       Eigen::AngleAxisd(-area.pitch_rad, Eigen::Vector3d::UnitY()));
      family.count(area.verdict, pipeline.query(box));
    }
  }
}

void print(const std::string& name, const Family& family) {
  const int all = family.free + family.blocked + family.unknown;
  std::printf("| %s | %d | %d / %d / %d | %.2f %% | %d | %.1f | %.1f |\n", name.c_str(), all, family.free,
              family.blocked, family.unknown, 100.0 * family.same / all, family.wrong_free,
              family.pair_ms / family.frames, family.areas_ms / family.frames);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 1;
  if (seeds < 1 || argc > 2) {
    std::fprintf(stderr, "usage: free_areas_table [SEEDS]: flies each family with so many seeds, from 6001 on\n");
    return 2;
  }
  std::printf(
      "| family | directions | FREE / BLOCKED / UNKNOWN | as the query | FREE where that is BLOCKED | pair, ms | "
      "free areas, ms |\n|---|---|---|---|---|---|---|\n");
  Family all;
  for (const std::string& scene : sim::sceneNames()) {
    Family family;
    for (int seed = 0; seed < seeds; ++seed) fly(scene, 6001 + seed, family);
    print(scene, family);
    all.frames += family.frames;
    all.pair_ms += family.pair_ms;
    all.areas_ms += family.areas_ms;
    for (int Family::*count : {&Family::free, &Family::blocked, &Family::unknown, &Family::same, &Family::wrong_free}) {
      all.*count += family.*count;
    }
  }
  print("**all**", all);
  return 0;
}
