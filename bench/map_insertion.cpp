// A depth frame into an octree: OctoMap's insertPointCloud, the same
// discretised, and OccupancyMap, in one run on the same frames. --costs prints
// CSV instead: cost against image size, resolution and range.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "sim/simulation.hpp"

namespace {

using namespace flight_corridor;

constexpr const char* kScenes[] = {"forest", "pole", "side_obstacles", "wall"};
constexpr std::size_t kFlown = 8;  // frames of a flight at 30 Hz
enum Method { kPlain, kDiscretised, kOurs, kMethods };
constexpr const char* kNames[] = {"insertPointCloud", "discretised", "ours"};

/// A depth image, and the same as OctoMap takes it: a courtesy to it, since
/// making the cloud is not timed.
struct View {
  cv::Mat depth_m;
  octomap::Pointcloud cloud_C;
  Eigen::Isometry3d T_M_C = Eigen::Isometry3d::Identity();
};

View makeView(const cv::Mat& depth_m, const StereoGeometry& geometry, const Eigen::Isometry3d& T_M_C) {
  View view{depth_m.clone(), {}, T_M_C};
  for (int v = 0; v < depth_m.rows; ++v) {
    for (int u = 0; u < depth_m.cols; ++u) {
      const Eigen::Vector3f p_C = geometry.point(u, v, depth_m.at<float>(v, u)).cast<float>();
      if (p_C.allFinite()) view.cloud_C.push_back(p_C.x(), p_C.y(), p_C.z());
    }
  }
  return view;
}

octomap::pose6d poseForOctomap(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3f p = pose.translation().cast<float>();
  const Eigen::Quaterniond q(pose.linear());
  return {octomap::point3d(p.x(), p.y(), p.z()), octomath::Quaternion(q.w(), q.x(), q.y(), q.z())};
}

/// One contender with a tree of its own. Rays of OctoMap end at the range, ours
/// at that depth: ours covers no less.
class Contender {
 public:
  Contender(Method method, const MapConfig& config, const StereoGeometry& geometry)
      : method_(method), range_m_(config.max_range_m), map_(config, geometry), tree_(map_.tree()) {}

  void clear() { method_ == kOurs ? map_.clear() : tree_.clear(); }

  void insert(const View& view) {
    if (method_ == kOurs) return map_.insert(view.depth_m, view.T_M_C);
    tree_.insertPointCloud(view.cloud_C, {0, 0, 0}, poseForOctomap(view.T_M_C), range_m_, false,
                           method_ == kDiscretised);
  }

  const octomap::OcTree& tree() const { return method_ == kOurs ? map_.tree() : tree_; }

 private:
  Method method_;
  double range_m_;
  OccupancyMap map_;
  octomap::OcTree tree_;  // with our map's log-odds
};

/// Depth of the pipeline's stereo on the middle of a scene's flight, with the
/// poses flown.
struct Flight {
  StereoGeometry geometry;
  std::vector<View> views;
};

Flight fly(const std::string& scene) {
  sim::SimulationOptions options;
  options.scene = scene;
  options.seed = 1;
  const sim::Simulation simulation(options);
  Flight flight{StereoGeometry(simulation.calibration()), {}};
  Pipeline pipeline(Config(), flight.geometry, Rig());
  const std::size_t middle = simulation.frameTimes().size() / 2;
  for (std::size_t i = middle; i < middle + kFlown; ++i) {
    pipeline.process(simulation.frame(i));
    const Eigen::Isometry3d T_W_C = simulation.T_W_B(simulation.frameTimes()[i]) * simulation.T_B_C();
    flight.views.push_back(makeView(pipeline.depth(), flight.geometry, T_W_C));
  }
  return flight;
}

const Flight& flown(const std::string& scene) {
  static std::map<std::string, Flight> flights;
  const auto found = flights.find(scene);
  return found != flights.end() ? found->second : flights.emplace(scene, fly(scene)).first->second;
}

struct Case {
  std::string scene;
  double resolution_m, range_m;
  bool kept;  ///< The flight's frames into one tree; false: one frame into an
              ///< empty tree, in the camera's frame.
  MapConfig config() const {
    MapConfig config;
    config.resolution_m = resolution_m;
    config.max_range_m = range_m;
    return config;
  }
};

void insertViews(benchmark::State& state, Method method, const Case& what) {
  std::vector<View> views = flown(what.scene).views;
  if (!what.kept) {
    views.resize(1);
    views[0].T_M_C.setIdentity();
  }
  Contender contender(method, what.config(), flown(what.scene).geometry);
  for (auto _ : state) {
    contender.clear();
    for (const View& view : views) contender.insert(view);
  }
  state.counters["frames"] = static_cast<double>(views.size());
  state.counters["cells"] = static_cast<double>(contender.tree().getNumLeafNodes());
  state.counters["memory"] = static_cast<double>(contender.tree().memoryUsage());
}

/// Prints each run as ever, and the ratios of all at the end.
class RatioReporter : public benchmark::ConsoleReporter {
 public:
  RatioReporter() : ConsoleReporter(OO_Tabular) {}  // no colours: it is for the README

  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      const std::string name = run.run_name.function_name;
      const std::size_t slash = name.find('/');
      const auto method = std::find(std::begin(kNames), std::end(kNames), name.substr(0, slash)) - std::begin(kNames);
      const double frames = run.counters.at("frames");
      rows_[name.substr(slash + 1)][method] = {run.GetAdjustedRealTime() / frames, run.GetAdjustedCPUTime() / frames};
    }
  }

  void printTable() const {
    std::printf(
        "\nTime per frame [ms], CPU time of ours on all its threads, and how many times sooner ours is done.\n");
    std::printf("%-32s %16s %12s %8s %8s | %16s %12s\n", "scene/resolution/range/tree", kNames[0], kNames[1], kNames[2],
                "its CPU", kNames[0], kNames[1]);
    for (const auto& [name, costs] : rows_) {
      const double ours_ms = costs[kOurs].time_ms;
      std::printf("%-32s %16.1f %12.1f %8.2f %8.2f | %15.0fx %11.0fx\n", name.c_str(), costs[kPlain].time_ms,
                  costs[kDiscretised].time_ms, ours_ms, costs[kOurs].cpu_ms, costs[kPlain].time_ms / ours_ms,
                  costs[kDiscretised].time_ms / ours_ms);
    }
  }

 private:
  struct Cost {
    double time_ms, cpu_ms;  // of a frame
  };

  std::map<std::string, std::array<Cost, kMethods>> rows_;
};

void registerCases() {
  for (const bool kept : {false, true}) {
    for (const double resolution_m : {0.10, 0.05}) {
      for (const double range_m : {5.0, 8.0}) {
        for (const char* scene : kScenes) {
          for (int method = 0; method < kMethods; ++method) {
            const Case what{scene, resolution_m, range_m, kept};
            char name[96];
            std::snprintf(name, sizeof name, "%s/%s/%.2fm/%.0fm/%s", kNames[method], scene, resolution_m, range_m,
                          kept ? "kept" : "empty");
            benchmark::RegisterBenchmark(name, insertViews, static_cast<Method>(method), what)
                ->MeasureProcessCPUTime()
                ->UseRealTime()
                ->Unit(benchmark::kMillisecond);
          }
        }
      }
    }
  }
}

/// Median CPU time of a few frames into an empty tree, in the camera's frame
/// [ms]; one where it takes long.
double medianCost(Contender& contender, const View& view) {
  constexpr double kLong_ms = 200.0;
  constexpr std::size_t kRuns = 9;
  std::vector<double> costs_ms;
  while (costs_ms.size() < kRuns && (costs_ms.empty() || costs_ms[0] < kLong_ms)) {
    const std::clock_t start = std::clock();
    contender.clear();
    contender.insert(view);
    costs_ms.push_back(1000.0 * (std::clock() - start) / CLOCKS_PER_SEC);
  }
  std::nth_element(costs_ms.begin(), costs_ms.begin() + costs_ms.size() / 2, costs_ms.end());
  return costs_ms[costs_ms.size() / 2];
}

std::size_t occupiedCells(const octomap::OcTree& tree) {
  std::size_t count = 0;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    count += tree.isNodeOccupied(*leaf) ? std::size_t{1} << 3 * (tree.getTreeDepth() - leaf.getDepth()) : 0;
  }
  return count;
}

/// One line of CSV for each method; exact depth, so that all image sizes see
/// the same surfaces.
void printCosts(const char* scene, double image_scale, double resolution_m, double range_m) {
  sim::SimulationOptions options;
  options.scene = scene;
  options.seed = 1;
  options.image_scale = image_scale;
  const sim::Simulation simulation(options);
  const StereoGeometry geometry(simulation.calibration());
  const View view =
      makeView(simulation.depth(simulation.frameTimes().size() / 2), geometry, Eigen::Isometry3d::Identity());
  for (const Method method : {kPlain, kOurs}) {
    Contender contender(method, Case{scene, resolution_m, range_m, false}.config(), geometry);
    const double cost_ms = medianCost(contender, view);
    std::printf("%s,%d,%g,%g,%s,%.3f,%zu,%zu,%zu\n", scene, geometry.size().width, resolution_m, range_m,
                kNames[method], cost_ms, occupiedCells(contender.tree()), contender.tree().getNumLeafNodes(),
                contender.tree().memoryUsage());
    std::fflush(stdout);
  }
}

/// Each quantity alone, about VGA, 0.10 m and 8 m.
void printAllCosts() {
  std::printf(
      "scene,width_px,resolution_m,range_m,method,cpu_ms,occupied,"
      "leaves,bytes\n");
  for (const char* scene : kScenes) {
    printCosts(scene, 1.0, 0.10, 8.0);
    for (const double image_scale : {0.5, 2.0}) printCosts(scene, image_scale, 0.10, 8.0);
    for (const double resolution_m : {0.20, 0.05, 0.025}) printCosts(scene, 1.0, resolution_m, 8.0);
    for (const double range_m : {2.0, 4.0, 16.0}) printCosts(scene, 1.0, 0.10, range_m);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == "--costs") {
    printAllCosts();
    return 0;
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  registerCases();
  RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  reporter.printTable();
}
