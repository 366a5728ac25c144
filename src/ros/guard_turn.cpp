#include "ros/guard_turn.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "flight_corridor/range/pending_readings.hpp"

namespace flight_corridor_ros {

namespace {

constexpr double kKept_s = 8.0;            // more than the largest max_age_s, and turn_delay_s
constexpr std::size_t kMostRates = 10000;  // where the clock stands still
constexpr double kBetween_s = 0.1;  // of two attitudes: at 1 rad/s a heading in between is known to a few degrees

/// Angle of a rotation about z, in (-pi, pi]: its twist in the swing-twist decomposition.
double turnAboutZ(const Eigen::Quaterniond& rotation) {
  const double half_rad = std::atan2(rotation.z(), rotation.w());
  return std::remainder(2.0 * half_rad, 2.0 * M_PI);
}

}  // namespace

/// A time that was set back ends what came before.
bool HeadingHistory::isNext(double stamp_s) {
  if (!headings_.empty() && headings_.back().stamp_s - stamp_s > flight_corridor::kLongestDelay_s) headings_.clear();
  return headings_.empty() || stamp_s > headings_.back().stamp_s;
}

void HeadingHistory::push(double stamp_s, double turned_rad) {
  headings_.push_back({stamp_s, headings_.empty() ? 0.0 : headings_.back().rad + turned_rad});
  while (headings_.front().stamp_s < stamp_s - kKept_s) headings_.pop_front();
}

void HeadingHistory::add(const ros::Time& stamp, const Eigen::Quaterniond& R_W_B) {
  if (!isNext(stamp.toSec())) return;
  push(stamp.toSec(), turnAboutZ(R_W_B * newest_R_W_B_.conjugate()));
  newest_R_W_B_ = R_W_B;
}

void HeadingHistory::add(const ros::Time& stamp, double rate_rad_s) {
  if (!isNext(stamp.toSec())) return;
  const double since_s = headings_.empty() ? 0.0 : stamp.toSec() - headings_.back().stamp_s;
  if (since_s > kBetween_s) headings_.clear();
  push(stamp.toSec(), rate_rad_s * since_s);
}

std::optional<HeadingHistory::Turn> HeadingHistory::since(const ros::Time& stamp) const {
  const double stamp_s = stamp.toSec();
  const auto after = std::lower_bound(headings_.begin(), headings_.end(), stamp_s,
                                      [](const Heading& heading, double time_s) { return heading.stamp_s < time_s; });
  if (after == headings_.end()) return std::nullopt;
  const bool is_same = after->stamp_s == stamp_s;
  if (!is_same && after == headings_.begin()) return std::nullopt;
  const Heading& before = is_same ? *after : *std::prev(after);
  const double apart_s = after->stamp_s - before.stamp_s;
  if (!(apart_s <= kBetween_s)) return std::nullopt;
  const double share = is_same ? 0.0 : (stamp_s - before.stamp_s) / apart_s;
  const double then_rad = before.rad + share * (after->rad - before.rad);
  return Turn{headings_.back().rad - then_rad, headings_.back().stamp_s};
}

void CommandedTurns::add(const ros::Time& now, double rate_rad_s) {
  const double now_s = now.toSec();
  if (!rates_.empty() && now_s < rates_.back().time_s) rates_.clear();
  if (!rates_.empty() && rates_.back().rad_s == rate_rad_s) return;  // still in force
  rates_.push_back({now_s, rate_rad_s});
  while (rates_.size() > kMostRates || (rates_.size() > 1 && rates_[1].time_s < now_s - kKept_s)) rates_.pop_front();
}

TurnRates CommandedTurns::ratesSince(double time_s) const {
  TurnRates range;
  for (auto rate = rates_.rbegin(); rate != rates_.rend(); ++rate) {
    range.right_rad_s = std::min(range.right_rad_s, rate->rad_s);
    range.left_rad_s = std::max(range.left_rad_s, rate->rad_s);
    if (rate->time_s <= time_s) break;  // in force at that time; those before it ended with it
  }
  return range;
}

TurnRange GuardTurn::since(const ros::Time& stamp, const ros::Time& now) const {
  std::vector<HeadingHistory::Turn> measured;
  double newest_s = stamp.toSec();
  for (const HeadingHistory* source : {&by_tf, &by_imu, &by_rate}) {
    const auto turn = source->since(stamp);
    if (!turn) continue;
    measured.push_back(*turn);
    newest_s = std::max(newest_s, turn->until_s);
  }
  if (measured.empty()) measured.push_back({0.0, newest_s});
  TurnRange range;
  for (const HeadingHistory::Turn& turn : measured) {
    if (newest_s - turn.until_s >= kBetween_s) continue;
    const double rest_s = std::max(0.0, now.toSec() - turn.until_s);
    const TurnRates rates = commanded.ratesSince(turn.until_s - delay_s_);
    range.right_rad = std::min(range.right_rad, turn.rad + rest_s * rates.right_rad_s);
    range.left_rad = std::max(range.left_rad, turn.rad + rest_s * rates.left_rad_s);
  }
  return range;
}

}  // namespace flight_corridor_ros
