#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/command_line.hpp"
#include "tools/programs.hpp"
#include "tools/score.hpp"

namespace flight_corridor::tools {
namespace {

struct EvaluateOptions {
  std::vector<std::string> results, truths;
  bool csv = false, fail_on_false_free = false;
};

Score scoreRecordings(const std::vector<std::string>& results, const std::vector<std::string>& truths) {
  if (results.size() != truths.size()) throw CLI::ValidationError("--result and --truth must be given equally often");
  Score score;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const std::vector<ResultRow> result_rows = readResults(results[i]);
    const std::vector<TruthRow> truth_rows = readTruth(truths[i]);
    try {
      addRecording(result_rows, truth_rows, score);
    } catch (const std::exception& error) {
      throw std::runtime_error(results[i] + " and " + truths[i] + ": " + error.what());
    }
  }
  return score;
}

void printShare(const char* what, int count, int total) {
  const double share = total > 0 ? 100.0 * count / total : kNaN;
  const Interval interval = wilsonInterval(count, total);
  std::printf("  %-26s %6d of %6d  %6.2f %%  (95 %% interval %.2f to %.2f %%)\n", what, count, total, share,
              100.0 * interval.lower, 100.0 * interval.upper);
}

void printReactions(const char* what, const ReactionSummary& summary) {
  if (summary.changes == 0) return;
  std::printf("  %-26s median %.3f s, longest %.3f s (%d frames), %d of %d missed\n", what, summary.median_s,
              summary.longest_s, summary.longest_frames, summary.missed, summary.changes);
}

void printReaction(const Reaction& reaction) {
  std::printf("  truth became %-7s at %s: ", toString(reaction.truth), formatStamp(reaction.stamp).c_str());
  if (std::isnan(reaction.delay_s)) {
    std::printf("verdict never followed (%d frames)\n", reaction.delay_frames);
  } else {
    std::printf("verdict followed after %.3f s (%d frames)\n", reaction.delay_s, reaction.delay_frames);
  }
}

/// The figures of the collision monitor's bag test in Nav2 (ROS 2): how a UAV stops and goes that flies while FREE.
void printStops(const Score& score) {
  std::vector<double> stops_s = score.stop_times_s;
  stops_s.erase(std::remove_if(stops_s.begin(), stops_s.end(), [](double stop_s) { return std::isnan(stop_s); }),
                stops_s.end());
  const ReactionSummary resumed = summarise(score.reactions, State::Free);
  std::printf("flying while FREE:\n");
  if (!score.stop_times_s.empty()) {
    std::printf("  %-26s median %.3f s, longest %.3f s, never in %zu of %zu\n", "time to stop", quantile(stops_s, 0.5),
                quantile(stops_s, 1.0), score.stop_times_s.size() - stops_s.size(), score.stop_times_s.size());
  }
  printShare("stop held", score.held, score.to_hold);
  printReactions("time to resume", resumed);
  printShare("false stops", score.false_block + score.unknown_of_free, score.free);
}

void printTable(const Score& score) {
  std::printf("frames: %d truly blocked, %d truly free, %d borderline (not scored)\n", score.blocked, score.free,
              score.borderline);
  std::printf("without a verdict: %d, of which %d truly blocked\n", score.unanswered, score.unanswered_blocked);
  printShare("false FREE", score.false_free, score.blocked);
  printShare("recordings with false FREE", score.recordings_false_free, score.recordings_blocked);
  printShare("false BLOCKED", score.false_block, score.free);
  printShare("UNKNOWN of truly blocked", score.unknown_of_blocked, score.blocked);
  printShare("UNKNOWN of truly free", score.unknown_of_free, score.free);
  std::printf("  distance error: median %.3f m, p95 %.3f m (%zu frames)\n", quantile(score.distance_errors_m, 0.5),
              quantile(score.distance_errors_m, 0.95), score.distance_errors_m.size());
  printReactions("appearance to BLOCKED", summarise(score.reactions, State::Blocked));
  printReactions("disappearance to FREE", summarise(score.reactions, State::Free));
  for (const Reaction& reaction : score.reactions) printReaction(reaction);
  printStops(score);
}

/// One line of --csv: each cell beside its column's name.
class CsvLine {
 public:
  void count(const std::string& name, long value) { add(name, std::to_string(value)); }
  void number(const std::string& name, double value) {
    std::array<char, 64> text;
    std::snprintf(text.data(), text.size(), "%.6f", value);
    add(name, std::isnan(value) ? "nan" : text.data());  // printf may write "-nan"
  }
  void share(const std::string& name, int value, int total) {
    const Interval interval = wilsonInterval(value, total);
    count(name, value);
    number(name + "_lower", interval.lower);
    number(name + "_upper", interval.upper);
  }
  void reactions(const std::string& name, const ReactionSummary& summary) {
    count(name + "_changes", summary.changes);
    count(name + "_missed", summary.missed);
    number(name + "_median_s", summary.median_s);
    number(name + "_longest_s", summary.longest_s);
    count(name + "_longest_frames", summary.longest_frames);
  }
  void print() const { std::printf("%s\n%s\n", header_.c_str(), cells_.c_str()); }

 private:
  void add(const std::string& name, const std::string& cell) {
    const char* separator = header_.empty() ? "" : ",";
    header_ += separator + name;
    cells_ += separator + cell;
  }

  std::string header_, cells_;
};

void printCsv(const Score& score) {
  CsvLine line;
  line.count("blocked", score.blocked);
  line.count("free", score.free);
  line.count("borderline", score.borderline);
  line.count("unanswered", score.unanswered);
  line.count("unanswered_blocked", score.unanswered_blocked);
  line.share("false_free", score.false_free, score.blocked);
  line.share("false_block", score.false_block, score.free);
  line.count("recordings_blocked", score.recordings_blocked);
  line.share("recordings_false_free", score.recordings_false_free, score.recordings_blocked);
  line.count("unknown_of_blocked", score.unknown_of_blocked);
  line.count("unknown_of_free", score.unknown_of_free);
  line.number("distance_error_median_m", quantile(score.distance_errors_m, 0.5));
  line.number("distance_error_p95_m", quantile(score.distance_errors_m, 0.95));
  line.reactions("appearance", summarise(score.reactions, State::Blocked));
  line.reactions("disappearance", summarise(score.reactions, State::Free));
  line.number("time_median_ms", quantile(score.frame_times_ms, 0.5));
  line.number("time_p95_ms", quantile(score.frame_times_ms, 0.95));
  line.print();
}

void evaluate(const EvaluateOptions& options) {
  const Score score = scoreRecordings(options.results, options.truths);
  options.csv ? printCsv(score) : printTable(score);
  const std::string complaint = falseFreeComplaint(score);
  if (options.fail_on_false_free && !complaint.empty()) throw std::runtime_error(complaint);
}

}  // namespace
}  // namespace flight_corridor::tools

int flight_corridor::programs::evaluate(int argc, char** argv) {
  using namespace tools;
  EvaluateOptions options;
  CLI::App app("Scores corridor verdicts against truth.", "evaluate");
  app.add_option("--result", options.results, "verdicts, as replay writes them")
      ->type_name("R.csv")
      ->required()
      ->allow_extra_args(false);
  app.add_option("--truth", options.truths, "truth of the same recording, as simulate writes it")
      ->type_name("T.csv")
      ->required()
      ->allow_extra_args(false);
  app.add_flag("--csv", options.csv, "print a header and one line of numbers instead of the table");
  app.add_flag("--fail-on-false-free", options.fail_on_false_free,
               "exit with 1 when a truly blocked frame was called FREE or has no\n"
               "verdict, or none was scored");
  app.footer(
      "Truly blocked: the exact box is hit. Truly free: not even the box 0.10 m larger on every side is.\n"
      "Between the two: borderline, not scored. Several --result --truth pairs are scored together.\n"
      "simulate's truth is that of the default box, 1.2 m x 0.4 m x 4 m from the camera along its axis: verdicts\n"
      "on another box do not belong to it.");
  return runTool(app, argc, argv, [&] { tools::evaluate(options); });
}
