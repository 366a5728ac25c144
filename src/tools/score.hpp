#pragma once

#include <string>
#include <vector>

#include "tools/csv.hpp"

namespace flight_corridor::tools {

/// How long the verdict took to follow one change of truth.
struct Reaction {
  ros::Time stamp;  ///< First frame of the new truth.
  State truth = State::Unknown;
  double delay_s = kNaN;  ///< NaN: truth changed again, or the recording ended, before the verdict followed.
  int delay_frames = 0;   ///< Wrong or unknown verdicts before the right one.
};

/// Verdicts of one or many recordings compared with truth.
struct Score {
  int recordings_blocked = 0, recordings_false_free = 0;  ///< With truly blocked frames; with one called FREE.
  int blocked = 0, free = 0, borderline = 0;              ///< Frames by truth.
  int unanswered = 0;                   ///< Frames of truth that have no verdict; not in the counts above.
  int unanswered_blocked = 0;           ///< Those of them that are truly blocked.
  int false_free = 0, false_block = 0;  ///< Said FREE of blocked, said BLOCKED of free.
  int unknown_of_blocked = 0, unknown_of_free = 0;
  std::vector<double> distance_errors_m;  ///< |clear distance - truth| where both say BLOCKED at a distance.
  std::vector<double> frame_times_ms;     ///< Time of each answer.
  std::vector<Reaction> reactions;
  std::vector<double> stop_times_s;  ///< From the first blocked frame after a free one to a verdict other than FREE;
                                     ///< NaN: there was none.
  int to_hold = 0, held = 0;         ///< Blocked frames after such a verdict; those of them not called FREE.
};

/// Adds one recording.
/// @throws std::runtime_error naming a stamp of the results that truth does not have.
void addRecording(const std::vector<ResultRow>& results, const std::vector<TruthRow>& truth, Score& score);

/// Why the verdicts do not show that nothing blocked was called FREE; "" when they do.
std::string falseFreeComplaint(const Score& score);

/// How the verdict followed all changes of truth to one state.
struct ReactionSummary {
  int changes = 0, missed = 0;               ///< Missed: the verdict never followed; not in the numbers below.
  double median_s = kNaN, longest_s = kNaN;  ///< NaN: no obstacle was followed.
  int longest_frames = 0;                    ///< Most frames that one took.
};
ReactionSummary summarise(const std::vector<Reaction>& reactions, State truth);

/// Two-sided 95 % confidence interval of a share (Wilson 1927); NaN when total is 0.
struct Interval {
  double lower = kNaN, upper = kNaN;
};
Interval wilsonInterval(int count, int total);

/// A static recording of one range.
struct SampleStatistics {
  std::size_t count = 0;
  double mean_m = kNaN;
  double variance_m2 = kNaN;  ///< Unbiased (n - 1); NaN with fewer than two samples.
  double slow_share = kNaN;   ///< Share of the variance that lies between the means of the recording's thirds [0..1].
};
SampleStatistics statistics(const std::vector<double>& samples_m);

/// Value below which the given share of the values lies, linear between values; NaN without values.
double quantile(std::vector<double> values, double share);

}  // namespace flight_corridor::tools
