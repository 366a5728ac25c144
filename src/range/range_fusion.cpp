#include "flight_corridor/range/range_fusion.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr double kFirstRateSigma_mps = 5.0;   // of a surface just met: quadrotors in this job fly below it
constexpr double kFastestSurface_mps = 10.0;  // a reading that takes a leap to more speed is of another surface
constexpr double kOtherRateSigma_mps = 2.0;   // of another surface on the beam, about the rate so far
constexpr double kSureOfRate = 1.0;           // sigmas
constexpr int kTooOften = 4;                  // equal readings: noise hardly allows that
constexpr double kTogether_s = 0.1;           // two gated sensors speak of the same surface when so close in time
constexpr double kAccelerationHolds_s = 0.1;  // of an IMU
constexpr double kLargestAcceleration_mps2 = 300.0;  // an IMU of +-16 g on each axis ends below
constexpr std::size_t kCapacity = 1024;              // readings in the buffer, whatever their stamps

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
                "positive if stereo_variance_m2 is 0", config.disparity_sigma_px);
  rules.require(config.gate_sigma > 0.0, "gate_sigma", "positive", config.gate_sigma);
  rules.require(config.lasting_s > 0.0, "lasting_s", "positive", config.lasting_s);
  rules.require(config.max_gap_s > 0.0, "max_gap_s", "positive", config.max_gap_s);
  rules.require(config.buffer_s > 0.0, "buffer_s", "positive", config.buffer_s);
  return rules.broken();
}

RangeFusion::RangeFusion(const FusionConfig& config) : config_(config) {
  throwIfBroken(check(config));
  steps_.reserve(kCapacity);
}

Outcome RangeFusion::add(Sensor sensor, double stamp_s, double range_m, double variance_m2, double common_sigma_1pm) {
  const bool valid = std::isfinite(stamp_s) && std::isfinite(range_m) && range_m > 0.0 && variance_m2 > 0.0 &&
                     std::isfinite(variance_m2) && common_sigma_1pm >= 0.0 && std::isfinite(common_sigma_1pm);
  if (!valid) return Outcome::Invalid;
  const Kind kind = sensor == Sensor::Lidar ? Kind::Lidar : Kind::Stereo;
  return insert({kind, stamp_s, range_m, variance_m2, common_sigma_1pm});
}

Outcome RangeFusion::addAcceleration(double stamp_s, double acceleration_mps2) {
  if (!std::isfinite(stamp_s) || !(std::abs(acceleration_mps2) <= kLargestAcceleration_mps2)) return Outcome::Invalid;
  return insert({Kind::Acceleration, stamp_s, acceleration_mps2, kNaN, 0.0});
}

/// Puts a reading where its stamp belongs and takes all later ones again.
Outcome RangeFusion::insert(const Reading& reading) {
  const bool too_late = !steps_.empty() && reading.stamp_s < steps_.back().reading.stamp_s - config_.buffer_s;
  if (too_late || reading.stamp_s < before_.stamp_s) return Outcome::TooLate;
  if (steps_.size() == kCapacity) forgetOldest();

  const auto later = [](const Reading& a, const Step& b) {  // ties in one order, whatever the order of arrival
    return std::make_pair(a.stamp_s, a.kind) < std::make_pair(b.reading.stamp_s, b.reading.kind);
  };
  const auto place = std::upper_bound(steps_.begin(), steps_.end(), reading, later);
  const auto inserted = static_cast<std::size_t>(place - steps_.begin());
  steps_.insert(place, {reading, {}, Outcome::Accepted});
  for (std::size_t i = inserted; i < steps_.size(); ++i) {
    steps_[i].after = i == 0 ? before_ : steps_[i - 1].after;
    steps_[i].outcome = update(steps_[i].after, steps_[i].reading);
  }
  return steps_[inserted].outcome;
}

/// Steps older than the buffer's duration are dropped together, at least a quarter: so forgetting is rare.
void RangeFusion::forgetOldest() {
  const double oldest_s = steps_.back().reading.stamp_s - config_.buffer_s;
  const auto needed = std::find_if(steps_.begin() + kCapacity / 4, steps_.end() - 1,
                                   [&](const Step& step) { return step.reading.stamp_s >= oldest_s; });
  before_ = (needed - 1)->after;
  steps_.erase(steps_.begin(), needed);
}

RangeEstimate RangeFusion::at(double stamp_s) const {
  const auto after =
      std::find_if(steps_.rbegin(), steps_.rend(), [&](const Step& step) { return step.reading.stamp_s <= stamp_s; });
  const Filter& newest = after == steps_.rend() ? before_ : after->after;
  if (!(newest.confirmed && newest.stamp_s <= stamp_s && stamp_s - newest.lastAccepted() <= config_.max_gap_s))
    return {};

  const Filter now = predicted(newest, stamp_s);
  RangeEstimate estimate;
  estimate.range_m = std::max(0.0, now.mean[0]);  // predicted: it may have been passed
  estimate.sigma_m = std::sqrt(now.covariance(0, 0));
  estimate.rate_mps = now.mean[1];
  for (const Sensor sensor : {Sensor::Lidar, Sensor::Stereo}) {
    const SensorTrack& track = now.tracks[static_cast<std::size_t>(sensor)];
    if (isContradicted(track, stamp_s)) estimate.disagreement = Disagreement{sensor, track.gated.value};
  }
  estimate.lidar_repeats = newest.repetition.readings >= kTooOften;
  return estimate;
}

/// x' = A x + B u, P' = A P A^T + Q with A = [1 dt; 0 1], B = [dt^2/2; dt], u = -acceleration: the range shrinks as the
/// rig speeds up (Trejo 2019, eqs. 3, 4) and Q = sigma_a^2 [dt^3/3 dt^2/2; dt^2/2 dt] (Bar-Shalom 2001, eq. 6.2.2-12).
RangeFusion::Filter RangeFusion::predicted(const Filter& filter, double stamp_s) const {
  Filter next = filter;
  const double dt = stamp_s - filter.stamp_s;
  const bool driven = stamp_s - filter.acceleration_s <= kAccelerationHolds_s;
  const double u = driven ? -filter.acceleration_mps2 : 0.0;
  Eigen::Matrix2d A, Q;
  A << 1, dt, 0, 1;
  Q << dt * dt * dt / 3, dt * dt / 2, dt * dt / 2, dt;
  next.stamp_s = stamp_s;
  next.mean = A * filter.mean + Eigen::Vector2d(dt * dt / 2, dt) * u;
  next.covariance = A * filter.covariance * A.transpose() + squared(config_.acceleration_sigma_mps2) * Q;
  return next;
}

void RangeFusion::initialise(Filter& filter, const Reading& reading, double rate_sigma_mps) {
  filter.stamp_s = reading.stamp_s;
  filter.mean[0] = reading.value;
  filter.covariance << reading.variance_m2, 0, 0, squared(rate_sigma_mps);
  filter.common_sigma_1pm = reading.common_sigma_1pm;
}

Outcome RangeFusion::update(Filter& filter, const Reading& reading) const {
  if (reading.kind != Kind::Acceleration) {
    watchRepetition(filter, reading);
    const bool refused = reading.kind == Kind::Lidar && filter.repetition.isFrozen() && !isBefore(reading, filter);
    return refused ? Outcome::Gated : correct(filter, reading);
  }
  if (filter.initialised()) filter = predicted(filter, reading.stamp_s);
  filter.acceleration_s = reading.stamp_s;
  filter.acceleration_mps2 = reading.value;
  return Outcome::Accepted;
}

/// A LiDAR that repeats itself while the range goes on changing, or stereo moves, is frozen, until it says something
/// else.
void RangeFusion::watchRepetition(Filter& filter, const Reading& reading) const {
  Repetition& repetition = filter.repetition;
  if (reading.kind == Kind::Lidar) {
    if (reading.value != repetition.lidar_m) {
      repetition = Repetition();
      repetition.lidar_m = reading.value;
      repetition.since_s = reading.stamp_s;
      repetition.speed_mps = std::abs(filter.mean[1]) - kSureOfRate * std::sqrt(filter.covariance(1, 1));
    }
    ++repetition.readings;
    const double travelled_m = repetition.speed_mps * (reading.stamp_s - repetition.since_s);
    repetition.overdue |= travelled_m > config_.gate_sigma * std::sqrt(reading.variance_m2);
  } else if (std::isnan(repetition.stereo_m)) {
    repetition.stereo_m = reading.value;
    repetition.stereo_variance_m2 = reading.variance_m2;
  } else if (reading.stamp_s - repetition.since_s >= config_.lasting_s) {
    const bool elsewhere =
        differ(repetition.stereo_m, repetition.stereo_variance_m2, reading.value, reading.variance_m2);
    if (!repetition.isFrozen()) repetition.moved = elsewhere ? repetition.moved + 1 : 0;
  }
}

/// Whether a LiDAR that repeats itself met something nearer than stereo from the start: glass before a moving scene.
bool RangeFusion::isBefore(const Reading& lidar, const Filter& filter) const {
  const Repetition& repetition = filter.repetition;
  return lidar.value < repetition.stereo_m &&
         differ(lidar.value, lidar.variance_m2, repetition.stereo_m, repetition.stereo_variance_m2);
}

/// One range: predict, gate by its normalised innovation, correct (Trejo 2019, eqs. 5-9, C = [1 0]).
Outcome RangeFusion::correct(Filter& filter, const Reading& reading) const {
  SensorTrack& own = filter.tracks[track(reading)];
  const auto accept = [&](Outcome outcome) {
    own.period_s = reading.stamp_s - own.accepted_s;
    own.accepted_s = reading.stamp_s;
    own.gated_since_s = own.gated.stamp_s = kNaN;
    return outcome;
  };
  const bool forgotten = !filter.initialised() || !(reading.stamp_s - filter.lastAccepted() <= config_.max_gap_s);
  if (forgotten) {
    filter.mean.setZero();
    filter.confirmed = false;
    initialise(filter, reading, kFirstRateSigma_mps);
    return accept(Outcome::Reinitialised);
  }

  const double held_variance_m2 = filter.covariance(0, 0);
  filter = predicted(filter, reading.stamp_s);
  if (isWithinGate(filter, reading, held_variance_m2)) {
    const double innovation = reading.value - filter.mean[0];
    double variance_m2 = reading.variance_m2;
    double& whose_m2 = reading.common_sigma_1pm > filter.common_sigma_1pm ? variance_m2 : filter.covariance(0, 0);
    whose_m2 += commonVariance(filter, reading);
    const Eigen::Vector2d gain = filter.covariance.col(0) / (filter.covariance(0, 0) + variance_m2);
    filter.mean += gain * innovation;
    filter.covariance -= gain * filter.covariance.row(0).eval();
    filter.common_sigma_1pm += gain[0] * (reading.common_sigma_1pm - filter.common_sigma_1pm);
    filter.confirmed = true;
    return accept(Outcome::Accepted);
  }

  remember(own, reading);
  if ((filter.confirmed || isBeyondOther(filter, reading)) && !bothJumped(filter, reading)) {
    if (!rulesAlone(filter, reading)) return Outcome::Gated;
    contradict(filter.tracks[1 - track(reading)], filter, reading.stamp_s);
  }
  filter.mean[1] = std::clamp(filter.mean[1], -kFirstRateSigma_mps, kFirstRateSigma_mps);  // mostly our own: it stays
  initialise(filter, reading, kOtherRateSigma_mps);
  return accept(Outcome::Reinitialised);
}

/// Of the difference between a reading and the estimate, by the error that is common to all of a sensor's readings: in
/// the inverse range, as a disparity's offset is.
double RangeFusion::commonVariance(const Filter& filter, const Reading& reading) {
  return squared((reading.common_sigma_1pm - filter.common_sigma_1pm) * reading.value * filter.mean[0]);
}

/// Whether a reading can be of the surface that the filter, predicted to its stamp, follows. In persistent disagreement
/// a sensor has to come closer to be believed again; a slower one's pause brings none closer.
/// @param held_variance_m2 of the range before the prediction.
bool RangeFusion::isWithinGate(const Filter& filter, const Reading& reading, double held_variance_m2) const {
  if (std::isinf(config_.gate_sigma)) return true;
  const bool contradicted = isContradicted(filter.tracks[track(reading)], reading.stamp_s);
  const double gate_sigma = (contradicted ? 0.5 : 1.0) * config_.gate_sigma;
  const double reading_m2 = reading.variance_m2 + commonVariance(filter, reading);
  const double predicted_variance_m2 = filter.covariance(0, 0) + reading_m2;
  const double gate_variance_m2 =
      contradicted && isBeyondOther(filter, reading) ? held_variance_m2 + reading_m2 : predicted_variance_m2;
  const double innovation = reading.value - filter.mean[0];
  const double rate_change = filter.covariance(1, 0) / predicted_variance_m2 * innovation;
  const bool leaps =
      std::abs(rate_change) > kFirstRateSigma_mps && std::abs(filter.mean[1] + rate_change) > kFastestSurface_mps;
  return squared(innovation) <= squared(gate_sigma) * gate_variance_m2 && !leaps;
}

/// Whether a reading is farther than the other sensor's range.
bool RangeFusion::isBeyondOther(const Filter& filter, const Reading& reading) const {
  return reading.value > filter.mean[0] && isFollowed(filter.tracks[1 - track(reading)], reading.stamp_s);
}

/// Remembers a gated reading; a run of them lasts as long as they are of one surface, one outlier at a time apart. A
/// nearer surface that an outlier was of before takes the run over: two readings agree on it.
void RangeFusion::remember(SensorTrack& track, const Reading& reading) const {
  const auto follows = [&](const Reading& earlier) {
    return reading.stamp_s - earlier.stamp_s <= config_.max_gap_s && agree(earlier, reading);
  };
  const bool recent = reading.stamp_s - track.gated.stamp_s <= config_.max_gap_s;
  const bool nearer_again = recent && reading.value < track.gated.value && follows(track.ignored);
  const bool known = follows(track.gated) || nearer_again;
  track.outlier = recent && !known && !track.outlier;
  if (track.outlier) {
    track.ignored = reading;
    return;
  }
  if (!known) track.gated_since_s = reading.stamp_s;
  track.gated = reading;
}

/// Whether two ranges can be of one surface; NaN never is.
bool RangeFusion::agree(const Reading& earlier, const Reading& later) const {
  const double variance =
      earlier.variance_m2 + later.variance_m2 + squared(kFirstRateSigma_mps * (later.stamp_s - earlier.stamp_s));
  return squared(earlier.value - later.value) <= squared(config_.gate_sigma) * variance;
}

bool RangeFusion::differ(double a_m, double a_variance_m2, double b_m, double b_variance_m2) const {
  return squared(a_m - b_m) > squared(config_.gate_sigma) * (a_variance_m2 + b_variance_m2);
}

/// Whether the other sensor jumped to a gated reading's surface too. A lone LiDAR outlier may agree with a stereo peak:
/// only the LiDAR's second word makes a surface farther.
bool RangeFusion::bothJumped(const Filter& filter, const Reading& reading) const {
  const SensorTrack& other = filter.tracks[1 - track(reading)];
  const SensorTrack& lidar = filter.tracks[0];
  return reading.stamp_s - other.gated.stamp_s <= kTogether_s && agree(other.gated, reading) &&
         (lidar.gatedFor() > 0.0 || reading.value < filter.mean[0]);
}

/// Whether a gated reading's surface has lasted, and the other sensor is silent or farther. A lone outlier is of none.
bool RangeFusion::rulesAlone(const Filter& filter, const Reading& reading) const {
  const SensorTrack& own = filter.tracks[track(reading)];
  const SensorTrack& other = filter.tracks[1 - track(reading)];
  const bool lasting = !own.outlier && reading.stamp_s - own.gated_since_s >= config_.lasting_s;
  return lasting && (!isFollowed(other, reading.stamp_s) || reading.value < filter.mean[0]);
}

/// Whether the estimate still is a sensor's: between its readings it is not silent, nor while they are on their way.
bool RangeFusion::isFollowed(const SensorTrack& track, double stamp_s) const {
  return stamp_s - track.accepted_s <= std::min(track.period_s, config_.max_gap_s) + config_.lasting_s;
}

/// Whether a sensor is in persistent disagreement with the estimate.
bool RangeFusion::isContradicted(const SensorTrack& track, double stamp_s) const {
  return stamp_s - track.gated.stamp_s <= config_.max_gap_s && track.gatedFor() >= config_.lasting_s;
}

/// The sensor that the estimate followed is in persistent disagreement from now on.
void RangeFusion::contradict(SensorTrack& followed, const Filter& filter, double stamp_s) const {
  if (!isFollowed(followed, stamp_s)) return;
  followed.gated = {followed.gated.kind, stamp_s, filter.mean[0], filter.covariance(0, 0)};
  followed.gated_since_s = -kInfinity;
  followed.outlier = false;
}

}  // namespace flight_corridor
