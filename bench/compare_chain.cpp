// What a frame costs from both images in to verdict out, side by side on the same pairs and cores, frame by frame in
// turn:
//
// paper  the paper's chain: SGBM and WLS filter, Kalman fusion with config/paper.yaml, scaled cloud, map, box; map and
//        box are ours
// stock  as one would build it from stock parts: SGBM as stereo_image_proc, insertPointCloud, box over the leaves
// ours   config/default.yaml
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "filled_disparity.hpp"
#include "flight_corridor/map/box_cells.hpp"
#include "flight_corridor/pipeline.hpp"
#include "ros/conversions.hpp"
#include "stock_octomap.hpp"
#include "tools/command_line.hpp"
#include "tools/progress.hpp"
#include "tools/replayer.hpp"
#include "tools/stereo_bag_reader.hpp"

namespace {

using namespace flight_corridor;

constexpr std::size_t kWarmUp = 5;  // frames that do not count

/// Stereo pairs of a bag, and between them its ranges.
struct Recording {
  std::unique_ptr<StereoGeometry> geometry;
  std::vector<StereoFrame> pairs;
  std::vector<RangeReading> ranges;
};

Recording record(const std::string& path, std::size_t most) {
  namespace shell = flight_corridor_ros;
  Recording recording;
  tools::StereoBagReader::Listener listener;
  listener.on_range = [&](const sensor_msgs::RangeConstPtr& range) {
    recording.ranges.push_back(shell::toReading(*range));
  };
  listener.on_pair = [&](const tools::StereoMessages& pair) {
    if (recording.pairs.size() == most) return;
    if (!recording.geometry) {
      recording.geometry = std::make_unique<StereoGeometry>(shell::toCalibration(*pair.left_info, *pair.right_info));
    }
    recording.pairs.push_back({pair.left->header.stamp.toSec(), shell::toGrey(pair.left)->image.clone(),
                               shell::toGrey(pair.right)->image.clone()});
  };
  tools::StereoBagReader(path, tools::StereoTopics()).play({}, listener);
  if (recording.pairs.size() <= kWarmUp) throw std::runtime_error(path + ": no more than 5 stereo pairs");
  return recording;
}

/// One chain: takes a pair, says what it makes of the corridor.
struct Chain {
  const char* name;
  std::function<State(const StereoFrame& pair)> judge;
};

/// Hands the readings up to a pair on, once.
template <class Sink>
void addRanges(const Recording& recording, const StereoFrame& pair, std::size_t& next, Sink& sink) {
  for (; next < recording.ranges.size() && recording.ranges[next].stamp_s <= pair.stamp_s; ++next) {
    sink.addRange(recording.ranges[next]);
  }
}

/// The LiDAR is taken to be the camera.
Chain ourChain(const Recording& recording, std::vector<Report>& reports) {
  const auto pipeline =
      std::make_shared<Pipeline>(Config(), *recording.geometry, Rig{opticalFromForward(), opticalFromForward()});
  return {"ours", [&, pipeline, next = std::size_t{0}](const StereoFrame& pair) mutable {
            addRanges(recording, pair, next, *pipeline);
            reports.push_back(pipeline->process(pair));
            return reports.back().verdict.state;
          }};
}

/// BLOCKED where d_K ends in the box or an occupied cell reaches into it.
struct PaperChain {
  PaperChain(const Config& config, const StereoGeometry& rig)
      : geometry(rig),
        ranges(config.lidar, config.fusion, config.scale, rig, opticalFromForward()),
        map(config.map, rig, rig.depth(bench::kDisparities_px)),
        box(corridorBox(config.corridor, opticalFromForward())) {}

  State judge(const StereoFrame& pair) {
    filled.compute(pair.left, pair.right, geometry, disparity_px);
    const double fused_m = ranges.update(pair.stamp_s, disparity_px).range.range_m;
    correctedDepth(disparity_px, ranges.scale(), geometry, depth_m);
    map.clear();
    map.insert(depth_m, Eigen::Isometry3d::Identity(), true);
    const double occupied_m = nearestOccupied(map.tree(), box).clear_distance_m;
    return std::fmin(fused_m, occupied_m) < box.size_m.x() ? State::Blocked : State::Free;
  }

  StereoGeometry geometry;
  bench::FilledDisparity filled;
  RangeTracker ranges;
  OccupancyMap map;
  Box box;
  cv::Mat disparity_px, depth_m;
};

Chain paperChain(const Config& config, const Recording& recording) {
  const auto chain = std::make_shared<PaperChain>(config, *recording.geometry);
  return {"paper", [&, chain, next = std::size_t{0}](const StereoFrame& pair) mutable {
            addRanges(recording, pair, next, chain->ranges);
            return chain->judge(pair);
          }};
}

Chain stockChain(const Recording& recording) {
  const auto stock = std::make_shared<bench::StockOctomap>(*recording.geometry);
  const Box box = corridorBox(CorridorConfig(), opticalFromForward());
  return {"stock", [stock, box](const StereoFrame& pair) {
            stock->insert(pair.left, pair.right);
            if (stock->empty()) return State::Unknown;
            return stock->clearDistance(box, 1) < box.size_m.x() ? State::Blocked : State::Free;
          }};
}

double processorTime() {  // of all threads [ms]
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  const auto ms = [](const timeval& time) { return 1e3 * static_cast<double>(time.tv_sec) + 1e-3 * time.tv_usec; };
  return ms(usage.ru_utime) + ms(usage.ru_stime);
}

/// A line of /proc/self/status [MiB].
double memory(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kib = 0.0;
    if (word == key && status >> kib) return kib / 1024.0;
  }
  throw std::runtime_error("/proc/self/status lacks " + key);
}

/// What a chain's frames take at most beyond what was there before: in a process of its own, which has done nothing.
double peakMemory(const std::function<Chain()>& make, const Recording& recording) {
  std::array<int, 2> ends;
  if (pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
  const pid_t child = fork();
  if (child == 0) {
    std::ofstream("/proc/self/clear_refs") << "5";  // the peak begins now
    const double before_mib = memory("VmRSS:");
    const Chain chain = make();
    for (std::size_t i = 0; i < 2 * kWarmUp && i < recording.pairs.size(); ++i) chain.judge(recording.pairs[i]);
    const double peak_mib = memory("VmHWM:") - before_mib;
    _exit(write(ends[1], &peak_mib, sizeof peak_mib) == sizeof peak_mib ? 0 : 1);
  }
  double peak_mib = kNaN;
  const bool has_peak = child > 0 && read(ends[0], &peak_mib, sizeof peak_mib) == sizeof peak_mib;
  waitpid(child, nullptr, 0);
  for (const int end : ends) close(end);
  return has_peak ? peak_mib : kNaN;
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

struct Cost {
  std::vector<double> wall_ms;
  double processor_ms = 0.0;
  std::array<int, 3> states{};
};

/// A frame by each in turn: whatever else the machine does slows all alike.
std::vector<Cost> run(const std::vector<Chain>& chains, const Recording& recording) {
  std::vector<Cost> costs(chains.size());
  tools::Progress progress("compare_chain", recording.pairs.size());
  for (std::size_t i = 0; i < recording.pairs.size(); ++i) {
    for (std::size_t chain = 0; chain < chains.size(); ++chain) {
      const double processor_ms = processorTime();
      const auto start = std::chrono::steady_clock::now();
      const State state = chains[chain].judge(recording.pairs[i]);
      const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start;
      if (i < kWarmUp) continue;
      costs[chain].wall_ms.push_back(wall.count());
      costs[chain].processor_ms += processorTime() - processor_ms;
      ++costs[chain].states[static_cast<std::size_t>(state)];
    }
    progress.advance();
  }
  return costs;
}

void printStages(const std::vector<Report>& reports) {
  std::printf("\nours, stage by stage [ms]\n%-8s %7s %7s\n", "stage", "median", "p99");
  const std::pair<const char*, double StageTimes::*> stages[] = {
      {"stereo", &StageTimes::stereo_ms}, {"fusion", &StageTimes::fusion_ms},     {"depth", &StageTimes::cloud_ms},
      {"map", &StageTimes::map_ms},       {"corridor", &StageTimes::corridor_ms}, {"total", &StageTimes::total_ms}};
  for (const auto& [name, stage] : stages) {
    std::vector<double> values;
    for (std::size_t i = kWarmUp; i < reports.size(); ++i) values.push_back(reports[i].times.*stage);
    std::printf("%-8s %7.1f %7.1f\n", name, quantile(values, 0.5), quantile(values, 0.99));
  }
}

void compare(const Recording& recording, const Config& paper) {
  std::vector<Report> reports;
  const std::array<std::function<Chain()>, 3> makers{[&] { return paperChain(paper, recording); },
                                                     [&] { return stockChain(recording); },
                                                     [&] { return ourChain(recording, reports); }};
  std::vector<double> peaks_mib;
  for (const auto& make : makers) peaks_mib.push_back(peakMemory(make, recording));
  std::vector<Chain> chains;
  for (const auto& make : makers) chains.push_back(make());
  const std::vector<Cost> costs = run(chains, recording);
  const double ours_ms = quantile(costs.back().wall_ms, 0.5);
  std::printf("%zu frames of %d x %d px, %d disparities, %d cores\n\n%-6s %9s %7s %7s %9s %6s   %s\n",
              costs.back().wall_ms.size(), recording.geometry->size().width, recording.geometry->size().height,
              Config().stereo.num_disparities_px, cv::getNumberOfCPUs(), "chain", "median ms", "p99 ms", "CPU ms",
              "peak MiB", "ratio", "UNKNOWN FREE BLOCKED");
  for (std::size_t i = 0; i < chains.size(); ++i) {
    const Cost& cost = costs[i];
    const double median_ms = quantile(cost.wall_ms, 0.5);
    std::printf("%-6s %9.1f %7.1f %7.1f %9.0f %6.1f   %7d %4d %7d\n", chains[i].name, median_ms,
                quantile(cost.wall_ms, 0.99), cost.processor_ms / static_cast<double>(cost.wall_ms.size()),
                peaks_mib[i], median_ms / ours_ms, cost.states[0], cost.states[1], cost.states[2]);
  }
  printStages(reports);
}

}  // namespace

int main(int argc, char** argv) {
  std::string bag, paper = "config/paper.yaml";
  std::size_t frames = 200;
  CLI::App app("Cost of a frame by the paper's chain, by stock parts and by ours.", "compare_chain");
  app.add_option("--bag", bag, "bag to read")->type_name("F.bag")->required();
  app.add_option("--paper", paper, "the paper's settings")->type_name("F.yaml");
  app.add_option("--frames", frames, "pairs that are read at most")
      ->type_name("N")
      ->check(tools::wholeNumber(6, std::numeric_limits<int>::max()));
  app.footer("CPU: of all threads, a frame. peak MiB: beyond what was there before, in a process of its own.");
  return tools::runTool(app, argc, argv, [&] { compare(record(bag, frames), tools::readConfig(paper, {}).core); });
}
