// Cost of looking at a box: with the eyes of one pair, for every frame, and in what a map remembers.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "flight_corridor/corridor/box_inspector.hpp"
#include "flight_corridor/corridor/corridor.hpp"
#include "flight_corridor/corridor/free_areas.hpp"
#include "flight_corridor/map/box_cells.hpp"
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
  Texture left_texture, right_texture;
  ClearRays rays(geometry);
  BarGaps gaps(geometry);
  const EarlierPairs earlier(geometry);
  const EarlierMatches earlier_matches(geometry, estimator.nearestDepth());
  BoxInspector inspector(geometry);
  const FreeAreasConfig areas;
  const std::vector<double> ahead{0.0};
  const bool is_one = state.range(1) == 0;
  const Fan fan(corridorBox(config, opticalFromForward()), is_one ? ahead : gridAngles(areas.yaw_rad, areas.step_rad),
                is_one ? ahead : gridAngles(areas.pitch_rad, areas.step_rad));
  const std::vector<double> lidar_px(fan.size(), kNaN);
  right_texture.find(pair.right);
  for (auto _ : state) {
    left_texture.find(pair.left);
    estimator.workers().run(ClearRays::kParts, [&](int part, int) {
      rays.look(part, disparity, left_texture.mask(), right_texture.mask(), correction);
    });
    gaps.find(disparity.best_px, left_texture.mask(), correction, config.smallest_obstacle_m);
    const PairEvidence evidence{pair, disparity, depth_m,         left_texture.mask(), rays,
                                gaps, earlier,   earlier_matches, correction,          estimator.nearestDepth()};
    benchmark::DoNotOptimize(inspector.inspect(fan, evidence, config, lidar_px, estimator.workers()));
  }
  state.SetLabel(kScenes[state.range(0)]);
}
BENCHMARK(BM_Corridor)
    ->ArgNames({"scene", "fan"})
    ->ArgsProduct({{0, 1, 2, 3}, {0, 1}})
    ->UseRealTime()
    ->Unit(benchmark::kMicrosecond);

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
  for (auto _ : state) {
    benchmark::DoNotOptimize(nearestOccupied(map.tree(), box));
    benchmark::DoNotOptimize(unknownFraction(map.tree(), box));
  }
}
BENCHMARK(BM_Cells)->ArgName("edge_m")->Arg(1)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
