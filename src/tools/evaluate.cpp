#include <cstdio>
#include <exception>
#include <iostream>
#include <stdexcept>

#include "tools/command_line.hpp"
#include "tools/score.hpp"

namespace flight_corridor::tools {
namespace {

Score scoreRecordings(const std::vector<std::string>& results, const std::vector<std::string>& truths) {
  if (results.empty()) throw UsageError("missing: --result R.csv --truth T.csv");
  if (results.size() != truths.size()) throw UsageError("--result and --truth must be given equally often");
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

std::vector<double> delays(const Score& score) {
  std::vector<double> delays_s;
  for (const Reaction& reaction : score.reactions) {
    if (reaction.delay_s == reaction.delay_s) delays_s.push_back(reaction.delay_s);
  }
  return delays_s;
}

void printShare(const char* what, int count, int total) {
  const double share = total > 0 ? 100.0 * count / total : kNaN;
  std::printf("  %-26s %6d of %6d  %6.2f %%  (95 %% upper bound %.2f %%)\n", what, count, total, share,
              100.0 * wilsonUpperBound(count, total));
}

void printTable(const Score& score) {
  std::printf("frames: %d truly blocked, %d truly free, %d borderline (not scored)\n", score.blocked, score.free,
              score.borderline);
  std::printf("without a verdict: %d, of which %d truly blocked\n", score.unanswered, score.unanswered_blocked);
  printShare("false FREE", score.false_free, score.blocked);
  printShare("false BLOCKED", score.false_block, score.free);
  printShare("UNKNOWN of truly blocked", score.unknown_of_blocked, score.blocked);
  printShare("UNKNOWN of truly free", score.unknown_of_free, score.free);
  std::printf("  distance error: median %.3f m, p95 %.3f m (%zu frames)\n", quantile(score.distance_errors_m, 0.5),
              quantile(score.distance_errors_m, 0.95), score.distance_errors_m.size());
  for (const Reaction& reaction : score.reactions) {
    std::printf("  truth became %-7s at %s: ", toString(reaction.truth), formatStamp(reaction.stamp).c_str());
    if (reaction.delay_s == reaction.delay_s) {
      std::printf("verdict followed after %.3f s (%d frames)\n", reaction.delay_s, reaction.delay_frames);
    } else {
      std::printf("verdict never followed (%d frames)\n", reaction.delay_frames);
    }
  }
}

void printCsv(const Score& score) {
  const std::vector<double> delays_s = delays(score);
  std::printf(
      "blocked,free,borderline,unanswered,unanswered_blocked,false_free,false_free_upper,false_block,false_block_upper,"
      "unknown_of_blocked,"
      "unknown_of_free,distance_error_median_m,distance_error_p95_m,changes,changes_missed,reaction_median_s,"
      "reaction_max_s\n");
  std::printf("%d,%d,%d,%d,%d,%d,%.6f,%d,%.6f,%d,%d,%.4f,%.4f,%zu,%zu,%.4f,%.4f\n", score.blocked, score.free,
              score.borderline, score.unanswered, score.unanswered_blocked, score.false_free,
              wilsonUpperBound(score.false_free, score.blocked), score.false_block,
              wilsonUpperBound(score.false_block, score.free), score.unknown_of_blocked, score.unknown_of_free,
              quantile(score.distance_errors_m, 0.5), quantile(score.distance_errors_m, 0.95), score.reactions.size(),
              score.reactions.size() - delays_s.size(), quantile(delays_s, 0.5), quantile(delays_s, 1.0));
}

int evaluate(const CommandLine& options) {
  const Score score = scoreRecordings(options.all("result"), options.all("truth"));
  options.given("csv") ? printCsv(score) : printTable(score);
  const std::string complaint = falseFreeComplaint(score);
  if (options.given("fail-on-false-free") && !complaint.empty()) throw std::runtime_error(complaint);
  return 0;
}

}  // namespace
}  // namespace flight_corridor::tools

int main(int argc, char** argv) {
  using namespace flight_corridor::tools;
  CommandLine options("evaluate", "Scores corridor verdicts against truth.");
  options.repeatable("result", "R.csv", "verdicts, as replay writes them")
      .repeatable("truth", "T.csv", "truth of the same recording, as simulate writes it")
      .flag("csv", "print a header and one line of numbers instead of the table")
      .flag("fail-on-false-free",
            "exit with 1 when a truly blocked frame was called FREE or has no verdict, or none was scored")
      .notes(
          "Truly blocked: the exact box is hit. Truly free: not even the box 0.10 m larger on every side is.\n"
          "Between the two: borderline, not scored. Several --result --truth pairs are scored together.");
  return runTool(options, argc, argv, [&] { return evaluate(options); });
}
