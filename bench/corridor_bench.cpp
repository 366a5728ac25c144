// Cost of asking the map about a box: the configured corridor for every frame, and any other box by query.
#include <benchmark/benchmark.h>

#include <string>

#include "flight_corridor/corridor/corridor.hpp"
#include "flight_corridor/map/occupancy_map.hpp"
#include "flight_corridor/stereo/disparity_estimator.hpp"
#include "sim/simulation.hpp"

namespace {

using namespace flight_corridor;

constexpr std::size_t kFrame = 6;  // nothing is in the box then
const char* const kScenes[] = {"wall", "forest", "narrow_gap", "side_obstacles"};

/// The map of one exact depth image.
/// @param T_M_C places the camera along the cells, or across them.
octomap::OcTree mapOf(const sim::Simulation& simulation, double resolution_m, const Eigen::Isometry3d& T_M_C) {
  MapConfig config;
  config.resolution_m = resolution_m;
  OccupancyMap map(config, StereoGeometry(simulation.calibration()));
  map.insert(simulation.depth(kFrame), T_M_C);
  return map.tree();
}

Eigen::Isometry3d pose(bool across_cells) {
  Eigen::Isometry3d T_M_C = Eigen::Isometry3d::Identity();
  if (across_cells) T_M_C.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
  return T_M_C;
}

sim::Simulation simulationOf(const std::string& scene) {
  sim::SimulationOptions options;
  options.scene = scene;
  options.seed = 1;
  options.rate_hz = 2.0;
  return sim::Simulation(options);
}

/// @param state.range(0..2)  scene, edge of a cell [mm], whether the camera looks across the cells.
void BM_Corridor(benchmark::State& state) {
  const sim::Simulation simulation = simulationOf(kScenes[state.range(0)]);
  const Eigen::Isometry3d T_M_C = pose(state.range(2) != 0);
  const octomap::OcTree map = mapOf(simulation, 1e-3 * static_cast<double>(state.range(1)), T_M_C);
  const DisparityEstimator estimator(StereoConfig(), StereoGeometry(simulation.calibration()), 0.0);
  const Corridor corridor((CorridorConfig()));
  for (auto _ : state) {
    const ConvexRegion observable_M = T_M_C.inverse().matrix().transpose() * estimator.observable();
    benchmark::DoNotOptimize(
        corridor.inspect(map, corridor.box(T_M_C * opticalFromForward()), T_M_C.translation(), observable_M));
  }
  state.SetLabel(kScenes[state.range(0)]);
}
BENCHMARK(BM_Corridor)
    ->ArgNames({"scene", "cell_mm", "across"})
    ->Unit(benchmark::kMicrosecond)
    ->Apply([](auto* corridors) {
      for (int scene = 0; scene < 4; ++scene) {
        for (const int cell_mm : {100, 50}) corridors->Args({scene, cell_mm, 0})->Args({scene, cell_mm, 1});
      }
    });

/// @param state.range(0)  edge of a cubic box across the cells [m], at 0.05 m; 20 m is about the largest that a query
/// may have.
void BM_LargeBox(benchmark::State& state) {
  const sim::Simulation simulation = simulationOf("forest");
  const octomap::OcTree map = mapOf(simulation, 0.05, Eigen::Isometry3d::Identity());
  const Box box{pose(true), Eigen::Vector3d::Constant(static_cast<double>(state.range(0)))};
  for (auto _ : state) benchmark::DoNotOptimize(inspectBox(map, box, ConvexRegion()));
}
BENCHMARK(BM_LargeBox)->ArgName("edge_m")->Arg(1)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
