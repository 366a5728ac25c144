#include "flight_corridor/range_fusion.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr double kFirstRateSigma_mps = 5.0;  // of a surface just met: quadrotors in this job fly below it
constexpr double kTogether_s = 0.1;          // two gated sensors speak of the same surface when so close in time

std::size_t index(Sensor sensor) { return static_cast<std::size_t>(sensor); }

double squared(double value) { return value * value; }

}  // namespace

Violations check(const FusionConfig& config) {
  Rules rules("fusion");
  rules.require(config.acceleration_sigma_mps2 >= 0.0, "acceleration_sigma_mps2", "not negative",
                config.acceleration_sigma_mps2);
  rules.require(config.lidar_variance_m2 > 0.0, "lidar_variance_m2", "positive", config.lidar_variance_m2);
  rules.require(config.stereo_variance_m2 >= 0.0, "stereo_variance_m2", "not negative", config.stereo_variance_m2);
  rules.require(config.disparity_sigma_px >= 0.0, "disparity_sigma_px", "not negative", config.disparity_sigma_px);
  rules.require(config.stereo_variance_m2 + config.disparity_sigma_px > 0.0, "disparity_sigma_px",
                "positive where stereo_variance_m2 is 0", config.disparity_sigma_px);
  rules.require(config.gate_sigma > 0.0, "gate_sigma", "positive", config.gate_sigma);
  rules.require(config.lasting_s > 0.0, "lasting_s", "positive", config.lasting_s);
  rules.require(config.max_gap_s > 0.0, "max_gap_s", "positive", config.max_gap_s);
  rules.require(config.buffer_s > 0.0, "buffer_s", "positive", config.buffer_s);
  return rules.broken();
}

RangeFusion::RangeFusion(const FusionConfig& config) : config_(config) { throwIfBroken(check(config)); }

void RangeFusion::reset() {
  before_ = Filter();
  steps_.clear();
}

Outcome RangeFusion::add(Sensor sensor, double stamp_s, double range_m, double variance_m2) {
  const bool valid = std::isfinite(stamp_s) && std::isfinite(range_m) && range_m > 0.0 && variance_m2 > 0.0 &&
                     std::isfinite(variance_m2);
  if (!valid) return Outcome::Invalid;
  if (!steps_.empty() && stamp_s < steps_.back().reading.stamp_s - config_.buffer_s) return Outcome::TooLate;

  const Reading reading{sensor, stamp_s, range_m, variance_m2};
  const auto later = [](const Reading& a, const Step& b) {  // ties in one order, whatever the order of arrival
    return std::make_pair(a.stamp_s, a.sensor) < std::make_pair(b.reading.stamp_s, b.reading.sensor);
  };
  const auto place = std::upper_bound(steps_.begin(), steps_.end(), reading, later);
  const auto inserted = static_cast<std::size_t>(place - steps_.begin());
  steps_.insert(place, {reading, {}, Outcome::Accepted});
  for (std::size_t i = inserted; i < steps_.size(); ++i) {
    steps_[i].after = i == 0 ? before_ : steps_[i - 1].after;
    steps_[i].outcome = update(steps_[i].after, steps_[i].reading);
  }
  const Outcome outcome = steps_[inserted].outcome;
  while (steps_.front().reading.stamp_s < steps_.back().reading.stamp_s - config_.buffer_s) {
    before_ = steps_.front().after;
    steps_.pop_front();
  }
  return outcome;
}

RangeEstimate RangeFusion::at(double stamp_s) const {
  const auto after =
      std::find_if(steps_.rbegin(), steps_.rend(), [&](const Step& step) { return step.reading.stamp_s <= stamp_s; });
  const Filter& newest = after == steps_.rend() ? before_ : after->after;
  if (!(newest.confirmed && newest.stamp_s <= stamp_s && stamp_s - newest.lastAccepted() <= config_.max_gap_s))
    return {};

  const Filter now = predicted(newest, stamp_s);
  RangeEstimate estimate;
  estimate.range_m = now.mean[0];
  estimate.sigma_m = std::sqrt(now.covariance(0, 0));
  estimate.rate_mps = now.mean[1];
  for (const SensorTrack& track : now.tracks) {
    const bool recent = stamp_s - track.gated_s <= config_.max_gap_s;
    if (recent && track.gated_s - track.gated_since_s >= config_.lasting_s) {
      estimate.disagreement = true;
      estimate.disagreeing_m = track.gated_m;
    }
  }
  return estimate;
}

/// x' = A x, P' = A P A^T + Q with A = [1 dt; 0 1] (Trejo 2019, eqs. 3, 4; u = 0) and
/// Q = sigma_a^2 [dt^3/3 dt^2/2; dt^2/2 dt] (Bar-Shalom 2001, eq. 6.2.2-12).
RangeFusion::Filter RangeFusion::predicted(const Filter& filter, double stamp_s) const {
  Filter next = filter;
  const double dt = stamp_s - filter.stamp_s;
  Eigen::Matrix2d A, Q;
  A << 1, dt, 0, 1;
  Q << dt * dt * dt / 3, dt * dt / 2, dt * dt / 2, dt;
  next.stamp_s = stamp_s;
  next.mean = A * filter.mean;
  next.covariance = A * filter.covariance * A.transpose() + squared(config_.acceleration_sigma_mps2) * Q;
  return next;
}

void RangeFusion::initialise(Filter& filter, double stamp_s, double range_m, double variance_m2) {
  filter.stamp_s = stamp_s;
  filter.mean[0] = range_m;  // the rate is mostly our own: it stays
  filter.covariance << variance_m2, 0, 0, squared(kFirstRateSigma_mps);
}

/// One reading: predict, gate by its normalised innovation, correct (Trejo 2019, eqs. 5-9, C = [1 0]).
Outcome RangeFusion::update(Filter& filter, const Reading& reading) const {
  SensorTrack& track = filter.tracks[index(reading.sensor)];
  const auto accept = [&](Outcome outcome) {
    track.accepted_s = reading.stamp_s;
    track.gated_since_s = track.gated_s = kNaN;
    return outcome;
  };
  const bool forgotten = !filter.initialised() || !(reading.stamp_s - filter.lastAccepted() <= config_.max_gap_s);
  if (forgotten) {
    filter = Filter();
    initialise(filter, reading.stamp_s, reading.range_m, reading.variance_m2);
    return accept(Outcome::Reinitialised);
  }

  filter = predicted(filter, reading.stamp_s);
  const double innovation = reading.range_m - filter.mean[0];
  const double innovation_variance = filter.covariance(0, 0) + reading.variance_m2;
  if (squared(innovation) <= squared(config_.gate_sigma) * innovation_variance) {
    const Eigen::Vector2d gain = filter.covariance.col(0) / innovation_variance;
    filter.mean += gain * innovation;
    filter.covariance -= gain * filter.covariance.row(0).eval();
    filter.confirmed = true;
    return accept(Outcome::Accepted);
  }

  remember(track, reading);
  if (filter.confirmed && !isNewSurface(filter, reading)) return Outcome::Gated;
  initialise(filter, reading.stamp_s, reading.range_m, reading.variance_m2);
  return accept(Outcome::Reinitialised);
}

/// Remembers a gated reading; a run of them lasts only as long as they tell of one surface.
void RangeFusion::remember(SensorTrack& track, const Reading& reading) const {
  const bool same_surface = agree(track.gated_m, track.gated_variance_m2, reading.range_m, reading.variance_m2,
                                  reading.stamp_s - track.gated_s);
  if (!same_surface) track.gated_since_s = reading.stamp_s;
  track.gated_s = reading.stamp_s;
  track.gated_m = reading.range_m;
  track.gated_variance_m2 = reading.variance_m2;
}

/// Whether two ranges taken apart_s from one another can be of one surface; NaN never is.
bool RangeFusion::agree(double a_m, double a_variance_m2, double b_m, double b_variance_m2, double apart_s) const {
  const double variance = a_variance_m2 + b_variance_m2 + squared(kFirstRateSigma_mps * apart_s);
  return apart_s <= kTogether_s && squared(a_m - b_m) <= squared(config_.gate_sigma) * variance;
}

/// A gated reading is a new surface when the other sensor jumped to it too, or when it has lasted and either the other
/// sensor is silent or the reading is the nearer one.
bool RangeFusion::isNewSurface(const Filter& filter, const Reading& reading) const {
  const SensorTrack& own = filter.tracks[index(reading.sensor)];
  const SensorTrack& other = filter.tracks[1 - index(reading.sensor)];
  if (agree(other.gated_m, other.gated_variance_m2, reading.range_m, reading.variance_m2,
            reading.stamp_s - other.gated_s)) {
    return true;
  }
  const bool lasting = reading.stamp_s - own.gated_since_s >= config_.lasting_s;
  const bool other_silent = reading.stamp_s - other.accepted_s > config_.lasting_s;
  return lasting && (other_silent || reading.range_m < filter.mean[0]);
}

}  // namespace flight_corridor
