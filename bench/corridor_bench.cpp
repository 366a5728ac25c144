// Cost of looking at a box: with the eyes of one pair, for every frame, and in what a map remembers.
#include <benchmark/benchmark.h>

#include <string>

#include "flight_corridor/corridor/box_inspector.hpp"
#include "flight_corridor/corridor/corridor.hpp"
#include "flight_corridor/map/occupancy_map.hpp"
#include "flight_corridor/stereo/disparity_estimator.hpp"
#include "flight_corridor/stereo/texture.hpp"
#include "sim/simulation.hpp"

namespace {

using namespace flight_corridor;

constexpr std::size_t kFrame = 6;  // nothing is in the box then
const char* const kScenes[] = {"wall", "forest", "narrow_gap", "side_obstacles"};

sim::Simulation simulationOf(const std::string& scene) {
  sim::SimulationOptions options;
  options.scene = scene;
  options.seed = 1;
  options.rate_hz = 2.0;
  return sim::Simulation(options);
}

/// What one pair shows of the configured corridor.
void BM_Corridor(benchmark::State& state) {
  const sim::Simulation simulation = simulationOf(kScenes[state.range(0)]);
  const StereoGeometry geometry(simulation.calibration());
  const StereoFrame pair = simulation.frame(kFrame);
  const CorridorConfig config;
  const ScaleCorrection correction((ScaleConfig()));
  DisparityEstimator estimator(StereoConfig(), geometry, config.smallest_obstacle_m);
  Disparity disparity;
  estimator.estimate(pair, disparity);
  cv::Mat depth_m;
  correctedDepth(disparity.best_px, correction, geometry, depth_m);
  Texture texture;
  ClearRays rays(geometry);
  BoxInspector inspector(geometry);
  const Box box_C = corridorBox(config, opticalFromForward());
  for (auto _ : state) {
    rays.look(disparity, texture.find(pair.left), correction);
    benchmark::DoNotOptimize(
        inspector.inspect(box_C, {pair, disparity, depth_m, texture.mask(), rays, correction, estimator.nearestDepth()},
                          config.blind_m, config.smallest_obstacle_m, false));
  }
  state.SetLabel(kScenes[state.range(0)]);
}
BENCHMARK(BM_Corridor)->ArgName("scene")->DenseRange(0, 3)->Unit(benchmark::kMicrosecond);

/// What a map remembers of a box.
/// @param state.range(0)  edge of a cubic box across the cells [m], at 0.05 m; 20 m is about the largest that a query
/// may have.
void BM_Cells(benchmark::State& state) {
  const sim::Simulation simulation = simulationOf("forest");
  MapConfig config;
  config.resolution_m = 0.05;
  OccupancyMap map(config, StereoGeometry(simulation.calibration()));
  map.insert(simulation.depth(kFrame), Eigen::Isometry3d::Identity());
  Box box{Eigen::Isometry3d::Identity(), Eigen::Vector3d::Constant(static_cast<double>(state.range(0)))};
  box.T_M_F.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
  for (auto _ : state) benchmark::DoNotOptimize(cellsIn(map.tree(), box));
}
BENCHMARK(BM_Cells)->ArgName("edge_m")->Arg(1)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
