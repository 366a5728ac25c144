// The method of Trejo, Martinez and Flores (2019) on a bag, beside this package's verdict on the same pairs.
//
// paper  SGBM and WLS filter; D_c is the mean depth in the window at D_min, d_L the LiDAR's range as if the LiDAR were
//        the camera; both go into the Kalman filter of config/paper.yaml; FREE when d_K >= D_min
// ours   the node's pipeline, as replay runs it
#include <rosbag/view.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "filled_disparity.hpp"
#include "paper_rule.hpp"
#include "ros/conversions.hpp"
#include "ros/image_scale.hpp"
#include "ros/memory.hpp"
#include "tools/bag_file.hpp"
#include "tools/command_line.hpp"
#include "tools/csv.hpp"
#include "tools/lost_pairs.hpp"
#include "tools/pictures.hpp"
#include "tools/progress.hpp"
#include "tools/replayer.hpp"
#include "tools/score.hpp"
#include "tools/stereo_bag_reader.hpp"
#include "tools/topic_finder.hpp"

namespace {

using namespace flight_corridor;
using Rows = std::vector<tools::ResultRow>;
namespace shell = flight_corridor_ros;

constexpr std::array<State, 3> kStates{State::Free, State::Blocked, State::Unknown};

/// Files; "" = none.
struct Files {
  std::string settings = FLIGHT_CORRIDOR_PAPER_SETTINGS, table, video, truth;
};

/// The paper's method, pair by pair.
class Paper {
 public:
  Paper(const tools::ReplayInput& input, const shell::NodeConfig& config, const Config& settings)
      : rule_(config.core.corridor, settings.lidar, settings.fusion),
        filled_(config.core.stereo.num_disparities_px),
        image_scale_(config.ros.scale) {
    rosbag::Bag bag;
    tools::openBag(input.bag, bag);
    const auto topics = findTopics(bag, input.topics, input.reading.calibration_files.empty());
    for (const rosbag::MessageInstance& message : rosbag::View(bag, rosbag::TopicQuery(topics.range))) {
      const auto range = tools::read<sensor_msgs::Range>(bag, message);
      ranges_.emplace_back(input.reading.by_stamps ? range->header.stamp : message.getTime(), shell::toReading(*range));
    }
  }

  tools::ResultRow judge(const tools::Answer& answer) {
    const tools::RecordedPair& pair = answer.messages;
    for (; next_ < ranges_.size() && ranges_[next_].first <= pair.recorded; ++next_) {
      rule_.addRange(ranges_[next_].second);
    }
    tools::ResultRow row;
    row.stamp = pair.header.stamp;
    if (!answer.pipeline) return row;  // the pair was refused
    const auto right = shell::toGrey(pair.right, shell::bitsOf(*pair.left, *pair.right));
    const cv::Mat scaled_right = shell::scaled(right->image, image_scale_);
    const auto start = std::chrono::steady_clock::now();
    filled_.compute(answer.pipeline->left(), scaled_right, answer.pipeline->geometry(), disparity_px_);
    verdict_ = rule_.judge(row.stamp.toSec(), disparity_px_, answer.pipeline->geometry());
    row.times.total_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    row.state = verdict_.state;
    row.range_stereo_m = verdict_.stereo_m;
    row.range_lidar_m = verdict_.lidar_m;
    row.range_fused_m = verdict_.fused_m;
    return row;
  }

  /// The last verdict, and what it is of.
  const bench::PaperVerdict& verdict() const { return verdict_; }
  const cv::Mat& disparity() const { return disparity_px_; }

 private:
  bench::PaperRule rule_;
  bench::FilledDisparity filled_;
  double image_scale_;
  std::vector<std::pair<ros::Time, RangeReading>> ranges_;  // with the times of recording
  std::size_t next_ = 0;
  bench::PaperVerdict verdict_;
  cv::Mat disparity_px_;
};

void writeTable(const std::string& path, const Rows& by_paper, const Rows& by_us) {
  const auto number = [](double value) { return std::isnan(value) ? std::string("nan") : cv::format("%.6f", value); };
  std::ofstream file(path);
  file << "stamp,paper_stereo_m,paper_lidar_m,paper_fused_m,paper_state,paper_ms,state,clear_distance_m,total_ms\n";
  for (std::size_t i = 0; i < by_us.size(); ++i) {
    const tools::ResultRow &paper = by_paper[i], &ours = by_us[i];
    file << tools::formatStamp(ours.stamp) << ',' << number(paper.range_stereo_m) << ',' << number(paper.range_lidar_m)
         << ',' << number(paper.range_fused_m) << ',' << toString(paper.state) << ',' << number(paper.times.total_ms)
         << ',' << toString(ours.state) << ',' << number(ours.clear_distance_m) << ',' << number(ours.times.total_ms)
         << '\n';
  }
  file.close();
  if (!file) throw std::runtime_error(path + ": cannot be written");
}

double medianTime(const Rows& rows) {
  std::vector<double> times_ms;
  for (const tools::ResultRow& row : rows) {
    if (row.times.total_ms > 0.0) times_ms.push_back(row.times.total_ms);  // it was not refused
  }
  return tools::quantile(times_ms, 0.5);
}

/// How many pairs each calls what, and in how many they agree.
void printSummary(const Rows& by_paper, const Rows& by_us) {
  const auto count = [&](const auto& fits) {
    int fitting = 0;
    for (std::size_t i = 0; i < by_us.size(); ++i) fitting += fits(by_paper[i].state, by_us[i].state);
    return fitting;
  };
  std::printf("%-16s %23s\n%-16s", "", "flight_corridor", "");
  for (const State state : kStates) std::printf(" %8s", toString(state));
  std::printf(" %8s\n", "all");
  for (const State paper : kStates) {
    std::printf("  paper %-8s", toString(paper));
    for (const State ours : kStates) {
      std::printf(" %8d", count([&](State a, State b) { return a == paper && b == ours; }));
    }
    std::printf(" %8d\n", count([&](State a, State) { return a == paper; }));
  }
  std::printf("  %-14s", "all");
  for (const State ours : kStates) std::printf(" %8d", count([&](State, State b) { return b == ours; }));
  const int agree = count([](State a, State b) { return a == b; });
  std::printf(" %8zu\nagree on %d, disagree on %d\n", by_us.size(), agree, static_cast<int>(by_us.size()) - agree);
  std::printf("median time: paper %.1f ms, flight_corridor %.1f ms\n", medianTime(by_paper), medianTime(by_us));
}

void printScore(const char* name, const Rows& rows, const std::vector<tools::TruthRow>& truth) {
  tools::Score score;
  addRecording(rows, truth, score);
  std::printf("  %-16s false FREE %d of %d (UNKNOWN %d), false BLOCKED %d of %d (UNKNOWN %d)\n", name, score.false_free,
              score.blocked, score.unknown_of_blocked, score.false_block, score.free, score.unknown_of_free);
}

/// @throws std::runtime_error when an output would overwrite what is to be read.
void keepInputs(const tools::ReplayInput& input, const Files& files) {
  for (const std::string& output : {files.table, files.video}) {
    for (const std::string& read : {input.bag, input.config, files.settings, files.truth}) {
      std::error_code neither_exists;
      if (!std::filesystem::equivalent(read, output, neither_exists)) continue;
      throw std::runtime_error(output + ": is to be read, and would be overwritten");
    }
  }
}

void compare(const tools::ReplayInput& input, const Files& files) {
  keepInputs(input, files);
  const shell::NodeConfig config = tools::readConfig(input.config, input.overrides);
  const Config settings = tools::readConfig(files.settings, {}).core;
  std::vector<tools::TruthRow> truth;
  if (!files.truth.empty()) truth = tools::readTruth(files.truth);
  const tools::StereoBagReader bag(input.bag, input.topics, input.reading);
  std::cerr << "paper: " << bag.describe() << "\n";
  if (!input.topics.range.empty() && input.topics.range != "none") bag.requireRanges();
  if (!input.topics.imu.empty()) bag.requireImu();
  if (!input.topics.odom.empty()) bag.requireOdometry();
  if (!bag.hasRanges()) std::cerr << "paper: " << input.bag << ": no ranges: stereo alone\n";

  Paper paper(input, config, settings);
  Rows by_paper, by_us;
  cv::VideoWriter video;
  const double rate_hz = std::fmax(bag.rate(), 1.0);  // AVI holds no slower one
  tools::Progress progress("paper", bag.leftImages());
  const tools::PairStamps heard = tools::Replayer(bag, config).run([&](const tools::Answer& answer) {
    by_us.push_back(tools::resultRow(answer.messages.header.stamp, answer.report));
    by_paper.push_back(paper.judge(answer));
    if (answer.pipeline && !files.video.empty()) {
      cv::Mat picture = drawBoth(*answer.pipeline, answer.report, paper.disparity(), paper.verdict());
      bench::addStrip("paper", by_paper, bag.leftImages(), picture);
      bench::addStrip("flight_corridor", by_us, bag.leftImages(), picture);
      tools::addToVideo(picture, files.video, rate_hz, video);
    }
    progress.advance();
  });
  const std::string lost = tools::describeLostPairs(by_us.size(), heard, config.ros);
  if (by_us.empty()) throw std::runtime_error(input.bag + ": " + lost);
  if (!lost.empty()) std::cerr << "paper: " << input.bag << ": only " << lost << "\n";
  if (!files.table.empty()) writeTable(files.table, by_paper, by_us);

  const CorridorConfig& corridor = config.core.corridor;
  std::printf("%s: %zu stereo pairs, window %g m x %g m at D_min %g m\n", input.bag.c_str(), by_us.size(),
              corridor.width_m, corridor.height_m, corridor.length_m);
  printSummary(by_paper, by_us);
  if (files.truth.empty()) return;
  std::printf("by truth, borderline pairs not scored:\n");
  printScore("paper", by_paper, truth);
  printScore("flight_corridor", by_us, truth);
}

}  // namespace

int main(int argc, char** argv) {
  tools::ReplayInput input;
  Files files;
  CLI::App app("The method of Trejo, Martinez and Flores (2019) on a bag, beside this package's verdicts.", "paper");
  addOptions(app, input);
  app.add_option("--csv", files.table, "table to write, a line per stereo pair")
      ->type_name("P.csv")
      ->check(tools::outputFile());
  app.add_option("--video", files.video, "video of both, side by side")->type_name("P.avi")->check(tools::outputFile());
  app.add_option("--truth", files.truth, "truth, as simulate writes it: tells what each gets wrong")
      ->type_name("T.csv");
  app.add_option("--paper", files.settings, "sections lidar and fusion for the paper's filter")->type_name("F.yaml");
  app.footer(
      "Paper: SGBM and WLS filter; D_c, the mean depth in the window, which has the corridor's width and height, at\n"
      "D_min, its length; d_L, the LiDAR's range, as if the LiDAR were the camera; d_K of both by the Kalman filter.\n"
      "FREE: d_K is at least D_min; UNKNOWN: there is no d_K. Table: paper_stereo_m is D_c, paper_lidar_m d_L,\n"
      "paper_fused_m d_K. simulate's truth is that of the default corridor.");
  shell::keepFreedMemory();
  return tools::runTool(app, argc, argv, [&] { compare(input, files); });
}
