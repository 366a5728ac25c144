#include "tools/score.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

namespace flight_corridor::tools {
namespace {

using Results = std::map<ros::Time, ResultRow>;

Results byStamp(const std::vector<ResultRow>& results, const std::vector<TruthRow>& truth) {
  std::map<ros::Time, ResultRow> sorted;
  for (const ResultRow& row : results) sorted.emplace(row.stamp, row);
  Results unmatched = sorted;
  for (const TruthRow& row : truth) unmatched.erase(row.stamp);
  if (!unmatched.empty()) {
    throw std::runtime_error("truth has no frame with the result's stamp " + formatStamp(unmatched.begin()->first) +
                             " (" + std::to_string(unmatched.size()) + " such): do the two belong together?");
  }
  return sorted;
}

void addBlocked(const ResultRow& result, const TruthRow& truth, Score& score) {
  ++score.blocked;
  if (result.state == State::Free) ++score.false_free;
  if (result.state == State::Unknown) ++score.unknown_of_blocked;
  if (result.state == State::Blocked && std::isfinite(result.clear_distance_m)) {
    score.distance_errors_m.push_back(std::abs(result.clear_distance_m - truth.clear_exact_m));
  }
}

void addFree(const ResultRow& result, Score& score) {
  ++score.free;
  if (result.state == State::Blocked) ++score.false_block;
  if (result.state == State::Unknown) ++score.unknown_of_free;
}

/// Follows truth through one recording and writes down how the verdict follows.
class ReactionClock {
 public:
  void add(State truth, const ResultRow& result, Score& score) {
    if (truth != State::Unknown && truth != truth_) {
      waiting_ = truth_ != State::Unknown;
      if (waiting_) score.reactions.push_back({result.stamp, truth, kNaN, 0});
      has_stopped_ = false;
      times_stop_ = waiting_ && truth == State::Blocked;
      if (times_stop_) score.stop_times_s.push_back(kNaN);
      truth_ = truth;
    }
    if (truth == State::Blocked) addStop(result, score);
    if (!waiting_) return;
    Reaction& reaction = score.reactions.back();
    if (result.state == truth_) {
      reaction.delay_s = (result.stamp - reaction.stamp).toSec();
      waiting_ = false;
    } else {
      ++reaction.delay_frames;
    }
  }

 private:
  /// A UAV that flies while the verdict is FREE stops, and stays.
  void addStop(const ResultRow& result, Score& score) {
    const bool stops = result.state != State::Free;
    if (has_stopped_) {
      ++score.to_hold;
      score.held += stops;
    } else if (stops) {
      has_stopped_ = true;
      if (times_stop_) score.stop_times_s.back() = (result.stamp - score.reactions.back().stamp).toSec();
    }
  }

  State truth_ = State::Unknown;
  bool waiting_ = false;
  bool has_stopped_ = false, times_stop_ = false;  // since truth became Blocked; if that was a change
};

double squaresBetweenThirds(const std::vector<double>& samples_m, double mean_m) {
  double squares_m2 = 0.0;
  for (std::size_t third = 0; third < 3; ++third) {
    const auto begin = samples_m.begin() + static_cast<std::ptrdiff_t>(third * samples_m.size() / 3);
    const auto end = samples_m.begin() + static_cast<std::ptrdiff_t>((third + 1) * samples_m.size() / 3);
    if (begin == end) continue;
    const auto count = static_cast<double>(end - begin);
    const double deviation_m = std::accumulate(begin, end, 0.0) / count - mean_m;
    squares_m2 += count * deviation_m * deviation_m;
  }
  return squares_m2;
}

/// What truth says of one frame: Blocked when the exact box is hit, Free when not even the inflated one is, and
/// Unknown, not scored, when only the inflated one is: no sensor could be blamed for either answer.
State trueState(const TruthRow& row) {
  if (std::isfinite(row.clear_exact_m)) return State::Blocked;
  return std::isfinite(row.clear_inflated_m) ? State::Unknown : State::Free;
}

}  // namespace

void addRecording(const std::vector<ResultRow>& results, const std::vector<TruthRow>& truth, Score& score) {
  const Results by_stamp = byStamp(results, truth);
  const int blocked_before = score.blocked, false_free_before = score.false_free;
  ReactionClock clock;
  for (const TruthRow& row : truth) {
    const State state = trueState(row);
    const auto result = by_stamp.find(row.stamp);
    if (result == by_stamp.end()) {
      ++score.unanswered;
      if (state == State::Blocked) ++score.unanswered_blocked;
      continue;
    }
    score.frame_times_ms.push_back(result->second.times.total_ms);
    if (state == State::Blocked) addBlocked(result->second, row, score);
    if (state == State::Free) addFree(result->second, score);
    if (state == State::Unknown) ++score.borderline;
    clock.add(state, result->second, score);
  }
  score.recordings_blocked += score.blocked > blocked_before;
  score.recordings_false_free += score.false_free > false_free_before;
}

std::string falseFreeComplaint(const Score& score) {
  if (score.false_free > 0) return "truly blocked frames called FREE: " + std::to_string(score.false_free);
  if (score.unanswered_blocked > 0) {
    return "truly blocked frames without a verdict: " + std::to_string(score.unanswered_blocked);
  }
  return score.blocked + score.free > 0 ? "" : "no frame could be scored";
}

ReactionSummary summarise(const std::vector<Reaction>& reactions, State truth) {
  ReactionSummary summary;
  std::vector<double> delays_s;
  for (const Reaction& reaction : reactions) {
    if (reaction.truth != truth) continue;
    ++summary.changes;
    if (std::isnan(reaction.delay_s)) {
      ++summary.missed;
      continue;
    }
    delays_s.push_back(reaction.delay_s);
    summary.longest_frames = std::max(summary.longest_frames, reaction.delay_frames);
  }
  summary.median_s = quantile(delays_s, 0.5);
  summary.longest_s = quantile(delays_s, 1.0);
  return summary;
}

/// (p + z^2/2n -+ z sqrt(p(1-p)/n + z^2/4n^2)) / (1 + z^2/n).
Interval wilsonInterval(int count, int total) {
  if (total == 0) return {};
  constexpr double kZ = 1.959964;  // 97.5 % quantile of the normal distribution
  const double n = total, p = count / n, z2 = kZ * kZ;
  const double centre = p + z2 / (2 * n), reach = kZ * std::sqrt(p * (1 - p) / n + z2 / (4 * n * n));
  return {std::max(0.0, (centre - reach) / (1 + z2 / n)), std::min(1.0, (centre + reach) / (1 + z2 / n))};
}

SampleStatistics statistics(const std::vector<double>& samples_m) {
  SampleStatistics result;
  result.count = samples_m.size();
  if (result.count < 2) return result;
  const auto count = static_cast<double>(result.count);
  result.mean_m = std::accumulate(samples_m.begin(), samples_m.end(), 0.0) / count;
  double squares_m2 = 0.0;
  for (const double sample_m : samples_m) squares_m2 += (sample_m - result.mean_m) * (sample_m - result.mean_m);
  result.variance_m2 = squares_m2 / (count - 1.0);
  result.slow_share = squares_m2 > 0.0 ? squaresBetweenThirds(samples_m, result.mean_m) / squares_m2 : 0.0;
  return result;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return kNaN;
  std::sort(values.begin(), values.end());
  const double position = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (position - static_cast<double>(below)) * (values[above] - values[below]);
}

}  // namespace flight_corridor::tools
