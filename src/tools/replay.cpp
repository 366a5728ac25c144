#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>

#include "ros/conversions.hpp"
#include "ros/image_scale.hpp"
#include "ros/memory.hpp"
#include "tools/bag_file.hpp"
#include "tools/calibration_file.hpp"
#include "tools/command_line.hpp"
#include "tools/csv.hpp"
#include "tools/lost_pairs.hpp"
#include "tools/map_file.hpp"
#include "tools/new_bag.hpp"
#include "tools/pictures.hpp"
#include "tools/programs.hpp"
#include "tools/progress.hpp"
#include "tools/replayer.hpp"
#include "tools/score.hpp"
#include "tools/stereo_bag_reader.hpp"
#include "tools/topic_finder.hpp"

namespace flight_corridor::tools {
namespace {

constexpr char kVerdictTopic[] = "/flight_corridor/corridor";
constexpr std::size_t kChangesShown = 20;
constexpr double kSlowestVideo_hz = 1.0;  // AVI holds no slower one

/// What is written; "" = not.
struct Outputs {
  std::string table, verdicts, map;
  PictureOptions pictures;
};

/// Topics that may be missing must be there when they are named.
void checkOptionalTopics(const StereoBagReader& bag, const ReplayInput& input) {
  if (!input.topics.range.empty() && input.topics.range != "none") bag.requireRanges();
  if (!input.topics.imu.empty()) bag.requireImu();
  if (!input.topics.odom.empty()) bag.requireOdometry();
  if (!bag.hasRanges()) std::cerr << "replay: " << input.bag << ": no ranges: stereo alone\n";
}

/// Verdicts as messages in a bag of their own.
class VerdictBag {
 public:
  VerdictBag(const std::string& path, const Config& config)
      : bag_(path), config_(config), box_size_m_(corridorBox(config.corridor, Eigen::Isometry3d::Identity()).size_m) {}

  void add(const Answer& answer) {
    auto verdict =
        flight_corridor_ros::toMessage(answer.messages.header, answer.report, box_size_m_, config_.speed, 0.0);
    verdict.latency = kNaN;  // without a clock, without a latency
    bag_.write(kVerdictTopic, answer.messages.recorded, verdict);
  }
  void close() { bag_.finish(); }

 private:
  NewBag bag_;
  Config config_;
  Eigen::Vector3d box_size_m_;
};

void printCounts(const std::vector<ResultRow>& rows) {
  for (const State state : {State::Free, State::Blocked, State::Unknown}) {
    const auto count =
        std::count_if(rows.begin(), rows.end(), [&](const ResultRow& row) { return row.state == state; });
    std::printf("  %-8s %6td  %5.1f %%\n", toString(state), count, 100.0 * count / rows.size());
  }
}

/// @param changes rows whose verdict differs from the one before.
void printChanges(const std::vector<ResultRow>& changes) {
  std::printf("changes of verdict:\n  %-20s  %-7s  %9s  %9s  %s\n", "stamp", "verdict", "clear [m]", "d_K [m]", "why");
  for (std::size_t i = 0; i < std::min(changes.size(), kChangesShown); ++i) {
    const ResultRow& row = changes[i];
    std::printf("  %-20s  %-7s  %9.3f  %9.3f  %s\n", formatStamp(row.stamp).c_str(), toString(row.state),
                row.clear_distance_m, row.range_fused_m, row.reasons.c_str());
  }
  if (changes.size() > kChangesShown) std::printf("  ... and %zu more\n", changes.size() - kChangesShown);
}

void printTimes(const std::vector<ResultRow>& rows) {
  const std::array<std::pair<const char*, double StageTimes::*>, 6> stages{{{"stereo", &StageTimes::stereo_ms},
                                                                            {"fusion", &StageTimes::fusion_ms},
                                                                            {"cloud", &StageTimes::cloud_ms},
                                                                            {"map", &StageTimes::map_ms},
                                                                            {"corridor", &StageTimes::corridor_ms},
                                                                            {"total", &StageTimes::total_ms}}};
  std::printf("median time [ms]:");
  for (const auto& [name, time] : stages) {
    std::vector<double> times_ms;
    for (const ResultRow& row : rows) times_ms.push_back(row.times.*time);
    std::printf("  %s %.2f", name, quantile(times_ms, 0.5));
  }
  std::printf("\n");
}

/// @throws std::runtime_error when there is no pair at all.
void requirePairs(const std::string& path, std::size_t pairs, const std::string& lost) {
  if (lost.empty()) return;
  if (pairs == 0) throw std::runtime_error(path + ": " + lost);
  std::cerr << "replay: " << path << ": only " << lost << "\n";
}

/// The image, in colour where it has colour; shares the message's data where nothing is to be done.
cv::Mat picture(const sensor_msgs::ImageConstPtr& message, double scale) {
  namespace encodings = sensor_msgs::image_encodings;
  const auto image = encodings::isColor(message->encoding) ? cv_bridge::toCvShare(message, encodings::BGR8)
                                                           : flight_corridor_ros::toGrey(message);
  return flight_corridor_ros::scaled(image->image, scale);
}

/// @throws std::runtime_error when an output would overwrite the bag or the configuration that is being read.
void keepInput(const ReplayInput& input, const Outputs& outputs) {
  for (const std::string& output : {outputs.table, outputs.verdicts, outputs.map, outputs.pictures.video}) {
    for (const std::string& read : {input.bag, input.config}) {
      std::error_code neither_exists;
      if (std::filesystem::equivalent(read, output, neither_exists)) {
        throw std::runtime_error(output + ": is to be read, and would be overwritten");
      }
    }
  }
}

/// What the bag holds, and what of it a replay would read.
void list(const ReplayInput& input) {
  rosbag::Bag bag;
  openBag(input.bag, bag);
  std::printf("%s", listTopics(bag).c_str());
  std::string would_read;
  try {
    would_read = "replay reads: " + StereoBagReader(input.bag, input.topics, input.reading).describe();
  } catch (const std::runtime_error& error) {
    would_read = "replay does not read it: " + std::string(error.what());
  }
  std::printf("%s\n", would_read.c_str());
}

void replay(const ReplayInput& input, Outputs outputs) {
  keepInput(input, outputs);
  if (outputs.pictures.every > 0 && outputs.pictures.overlay_folder.empty() &&
      outputs.pictures.evidence_folder.empty()) {
    throw std::runtime_error("--overlay-every: needs --overlays or --evidence");
  }
  const flight_corridor_ros::NodeConfig config = readConfig(input.config, input.overrides);
  const StereoBagReader bag(input.bag, input.topics, input.reading);
  std::cerr << "replay: " << bag.describe() << "\n";
  checkOptionalTopics(bag, input);
  if (!outputs.pictures.video.empty()) {
    outputs.pictures.video_frames = bag.leftImages();
    const double rate_hz = bag.rate();
    if (std::isfinite(rate_hz)) outputs.pictures.video_rate_hz = std::max(rate_hz, kSlowestVideo_hz);
  }
  Pictures pictures(outputs.pictures);
  std::optional<VerdictBag> verdicts;
  if (!outputs.verdicts.empty()) verdicts.emplace(outputs.verdicts, config.core);

  Replayer replayer(bag, config);
  const auto saveMap = [&] {
    if (!outputs.map.empty()) writeMap(outputs.map, replayer.map());
  };
  saveMap();  // fails now rather than after the work
  writeResults(outputs.table, {});

  std::vector<ResultRow> rows, changes;
  Progress progress("replay", bag.leftImages());
  const PairStamps heard = replayer.run([&](const Answer& answer) {
    const ResultRow row = resultRow(answer.messages.header.stamp, answer.report);
    if (rows.empty() || rows.back().state != row.state) changes.push_back(row);
    if (answer.pipeline)
      pictures.add(rows.size(), picture(answer.messages.left, config.ros.scale), *answer.pipeline, answer.report);
    if (verdicts) verdicts->add(answer);
    rows.push_back(row);
    progress.advance();
  });
  requirePairs(input.bag, rows.size(), describeLostPairs(rows.size(), heard, config.ros));
  writeResults(outputs.table, rows);
  saveMap();
  if (verdicts) verdicts->close();

  std::printf("%s: %zu stereo pairs\n", input.bag.c_str(), rows.size());
  printCounts(rows);
  printChanges(changes);
  printTimes(rows);
}

}  // namespace
}  // namespace flight_corridor::tools

int flight_corridor::programs::replay(int argc, char** argv) {
  using namespace tools;
  ReplayInput input;
  Outputs outputs;
  bool lists = false;
  CLI::App app("Runs the corridor pipeline on a bag.", "replay");
  addOptions(app, input);
  CLI::Option* csv = app.add_option("--csv", outputs.table, "table to write, a line per stereo pair; not with --list")
                         ->type_name("R.csv")
                         ->check(outputFile())
                         ->required();
  app.add_flag_callback(
      "--list",
      [&] {
        lists = true;
        csv->required(false);
      },
      "print the bag's topics, type, count and rate, and what would be read,\nand do no more");
  app.add_option("--out", outputs.verdicts, "bag to write: the verdicts as messages")
      ->type_name("G.bag")
      ->check(outputFile());
  app.add_option("--map", outputs.map,
                 "file for the last map: .ot with log-odds, .bt with free, occupied\nand unknown only")
      ->type_name("M.ot")
      ->check(outputFile());
  app.add_option("--overlays", outputs.pictures.overlay_folder,
                 "folder for pictures of overlay, matched depth (white: matched behind\nthe box, but fits in it as "
                 "well), filled depth and map, one at each\nchange of verdict")
      ->type_name("DIR");
  app.add_option(
         "--evidence", outputs.pictures.evidence_folder,
         "folder for pictures of the evidence: what each pixel shows about the\nbox, one at each change of verdict")
      ->type_name("DIR");
  app.add_option("--overlay-every", outputs.pictures.every, "overlays and evidence: and one at every N frames")
      ->type_name("N")
      ->check(wholeNumber(0, std::numeric_limits<int>::max()));
  app.add_option("--depth", outputs.pictures.depth_folder, "folder for corrected depth images, uint16 mm")
      ->type_name("DIR");
  app.add_option("--video", outputs.pictures.video,
                 "video of overlay, depth, the map from above, and the verdicts over\ntime")
      ->type_name("V.avi")
      ->check(outputFile());
  app.footer(
      "The node's pipeline without a master: the same bag gives the same table, times aside.\n"
      "Images are taken for raw, and rectified, where their CameraInfo or the calibration has distortion or a "
      "rotation\n"
      "and no word of their topic's name begins with \"rect\". Where imu and odometry are not named, each is used "
      "when\n"
      "it is the only one. --calib takes\n" +
      calibrationKinds());
  flight_corridor_ros::keepFreedMemory();
  return runTool(app, argc, argv, [&] { lists ? tools::list(input) : tools::replay(input, outputs); });
}
