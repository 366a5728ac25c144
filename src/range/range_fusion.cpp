#include "flight_corridor/range/range_fusion.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

namespace {

constexpr double kRateSigma_mps = 5.0;               // of a surface just met: quadrotors in this job fly below it
constexpr double kFastestSurface_mps = 10.0;         // a reading that takes a leap to more speed is of another surface
constexpr int kTooOften = 4;                         // equal readings: noise hardly allows that
constexpr double kAccelerationHolds_s = 0.1;         // of an IMU
constexpr double kLargestAcceleration_mps2 = 300.0;  // an IMU of +-16 g on each axis ends below
constexpr std::size_t kCapacity = 1024;              // readings in the buffer, whatever their stamps

double squared(double value) { return value * value; }

}  // namespace

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
  if (too_late || reading.stamp_s < before_.reading.stamp_s) return Outcome::TooLate;
  if (steps_.size() == kCapacity) forgetOldest();

  const auto later = [](const Reading& a, const Step& b) {  // ties in one order, whatever the order of arrival
    return std::make_pair(a.stamp_s, a.kind) < std::make_pair(b.reading.stamp_s, b.reading.kind);
  };
  const auto inserted = std::upper_bound(steps_.begin(), steps_.end(), reading, later) - steps_.begin();
  steps_.insert(steps_.begin() + inserted, {reading, {}, Outcome::Accepted});
  for (auto step = steps_.begin() + inserted; step != steps_.end(); ++step) {
    step->after = (step == steps_.begin() ? before_ : *(step - 1)).after;
    step->outcome = update(step->after, step->reading);
  }
  return steps_[inserted].outcome;
}

/// Steps older than the buffer's duration are dropped together, at least a quarter: so forgetting is rare.
void RangeFusion::forgetOldest() {
  const double oldest_s = steps_.back().reading.stamp_s - config_.buffer_s;
  const auto needed = std::find_if(steps_.begin() + kCapacity / 4, steps_.end() - 1,
                                   [&](const Step& step) { return step.reading.stamp_s >= oldest_s; });
  before_ = *(needed - 1);
  steps_.erase(steps_.begin(), needed);
}

RangeEstimate RangeFusion::at(double stamp_s) const {
  const auto newest =
      std::find_if(steps_.rbegin(), steps_.rend(), [&](const Step& step) { return step.reading.stamp_s <= stamp_s; });
  const Step& step = newest == steps_.rend() ? before_ : *newest;
  const Surface& followed = step.after.surfaces[0];
  const bool known = step.reading.stamp_s <= stamp_s && stamp_s - followed.lastSeen() <= config_.max_gap_s;
  if (!known || !followed.isConfirmed()) return {};

  const Surface now = predicted(followed, step.after, stamp_s);
  RangeEstimate estimate;
  estimate.range_m = std::max(0.0, now.mean[0]);  // predicted: it may have been passed
  estimate.sigma_m = std::sqrt(now.covariance(0, 0));
  estimate.rate_mps = now.mean[1];
  for (const Sensor sensor : {Sensor::Lidar, Sensor::Stereo}) {
    const Surface* other = elsewhere(step.after, static_cast<std::size_t>(sensor), stamp_s);
    if (other) estimate.disagreement = Disagreement{sensor, std::max(0.0, other->mean[0])};
  }
  estimate.lidar_repeats = step.after.repetition.readings >= kTooOften;
  return estimate;
}

/// Surfaces that nothing showed for fusion/max_gap_s are forgotten.
Outcome RangeFusion::update(Filter& filter, const Reading& reading) const {
  for (Surface& surface : filter.surfaces) {
    const bool known = reading.stamp_s - surface.lastSeen() <= config_.max_gap_s;
    surface = known ? predicted(surface, filter, reading.stamp_s) : Surface();
  }
  if (reading.kind != Kind::Acceleration) {
    const bool is_frozen = watchRepetition(filter.repetition, filter.surfaces[0], reading);
    return is_frozen ? Outcome::Gated : fuse(filter, reading);
  }
  filter.acceleration_s = reading.stamp_s;
  filter.acceleration_mps2 = reading.value;
  return Outcome::Accepted;
}

/// x' = A x + B u, P' = A P A^T + Q with A = [1 dt; 0 1], B = [dt^2/2; dt], u = -acceleration: the range shrinks as the
/// rig speeds up (Trejo 2019, eqs. 3, 4) and Q = sigma_a^2 [dt^3/3 dt^2/2; dt^2/2 dt] (Bar-Shalom 2001, eq. 6.2.2-12).
RangeFusion::Surface RangeFusion::predicted(const Surface& surface, const Filter& filter, double stamp_s) const {
  const double dt = stamp_s - surface.stamp_s;
  const double u = stamp_s - filter.acceleration_s <= kAccelerationHolds_s ? -filter.acceleration_mps2 : 0.0;
  Eigen::Matrix2d A, Q;
  A << 1, dt, 0, 1;
  Q << dt * dt * dt / 3, dt * dt / 2, dt * dt / 2, dt;
  Surface next = surface;
  next.stamp_s = stamp_s;
  next.mean = A * surface.mean + Eigen::Vector2d(dt * dt / 2, dt) * u;
  next.covariance = A * surface.covariance * A.transpose() + squared(config_.acceleration_sigma_mps2) * Q;
  return next;
}

Outcome RangeFusion::fuse(Filter& filter, const Reading& reading) const {
  Surface& followed = filter.surfaces[0];
  Surface& seen = surfaceOf(filter, reading);
  if (&seen == &followed && followed.isConfirmed()) return Outcome::Accepted;
  if (&seen != &followed && !replaces(seen, filter, reading)) return Outcome::Gated;
  std::swap(followed, seen);
  return Outcome::Reinitialised;
}

/// Corrects the surface followed if the reading fits it, else the challenger that it fits; while the sensor is
/// elsewhere, whichever it fits best: else the range would alternate. If it fits none, it begins one, in place of a
/// challenger that only this sensor saw, or else of the one not seen for longest.
RangeFusion::Surface& RangeFusion::surfaceOf(Filter& filter, const Reading& reading) const {
  const std::size_t sensor = sensorOf(reading);
  const bool is_elsewhere = elsewhere(filter, sensor, reading.stamp_s) != nullptr;
  auto& surfaces = filter.surfaces;
  Surface* seen = nullptr;
  double least = squared(config_.gate_sigma);
  for (Surface& surface : surfaces) {
    const double misfit = this->misfit(surface, reading);
    if (!(misfit <= least) || (seen && !is_elsewhere)) continue;
    seen = &surface;
    least = misfit;
  }
  if (seen) {
    correct(*seen, reading);
  } else {
    const Eigen::Vector2d mean(reading.value, surfaces[0].mean[1]);  // the rate is mostly the rig's own: it stays
    const Eigen::Vector2d variances(reading.variance_m2, squared(kRateSigma_mps));
    const auto needed = [&](const Surface& surface) {
      return std::make_pair(surface.readings[1 - sensor] > 0, surface.lastSeen());
    };
    seen = std::min_element(surfaces.begin() + (surfaces[0].count() > 0 ? 1 : 0), surfaces.end(),
                            [&](const Surface& a, const Surface& b) { return needed(a) < needed(b); });
    *seen = {reading.stamp_s, mean, variances.asDiagonal(), reading.common_sigma_1pm, reading.stamp_s};
  }
  ++seen->readings[sensor];
  seen->period_s[sensor] = reading.stamp_s - seen->seen_s[sensor];
  seen->seen_s[sensor] = reading.stamp_s;
  return *seen;
}

/// Square of the normalised innovation; NaN if there is no surface, or the reading needs too fast a one.
double RangeFusion::misfit(const Surface& surface, const Reading& reading) const {
  if (surface.count() == 0) return kNaN;
  const double innovation = reading.value - surface.mean[0];
  const double variance_m2 = surface.covariance(0, 0) + reading.variance_m2 + commonVariance(surface, reading);
  const double rate_change = surface.covariance(1, 0) / variance_m2 * innovation;
  const bool leaps =
      std::abs(rate_change) > kRateSigma_mps && std::abs(surface.mean[1] + rate_change) > kFastestSurface_mps;
  return leaps && std::isfinite(config_.gate_sigma) ? kNaN : squared(innovation) / variance_m2;
}

/// Of their difference, by the error that is common to all of a sensor's readings: in the inverse range, as a
/// disparity's offset is.
double RangeFusion::commonVariance(const Surface& surface, const Reading& reading) {
  return squared((reading.common_sigma_1pm - surface.common_sigma_1pm) * reading.value * surface.mean[0]);
}

/// By one range (Trejo 2019, eqs. 5-9, C = [1 0]).
void RangeFusion::correct(Surface& surface, const Reading& reading) {
  double variance_m2 = reading.variance_m2;
  double& whose_m2 = reading.common_sigma_1pm > surface.common_sigma_1pm ? variance_m2 : surface.covariance(0, 0);
  whose_m2 += commonVariance(surface, reading);
  const Eigen::Vector2d gain = surface.covariance.col(0) / (surface.covariance(0, 0) + variance_m2);
  surface.mean += gain * (reading.value - surface.mean[0]);
  surface.covariance -= gain * surface.covariance.row(0).eval();
  surface.common_sigma_1pm += gain[0] * (reading.common_sigma_1pm - surface.common_sigma_1pm);
}

/// The confirmed surface that a sensor persistently measures instead of the one followed; nullptr: none.
const RangeFusion::Surface* RangeFusion::elsewhere(const Filter& filter, std::size_t sensor, double stamp_s) const {
  const double followed_s = filter.surfaces[0].seen_s[sensor];
  const Surface* newest = nullptr;
  for (const Surface& surface : filter.surfaces) {
    const double seen_s = surface.seen_s[sensor];
    const double persistent_s = seen_s - std::max(followed_s, surface.begun_s);
    const bool persists = persistent_s >= config_.lasting_s && stamp_s - seen_s <= config_.max_gap_s;
    if (surface.isConfirmed() && persists && !(newest && seen_s < newest->seen_s[sensor])) newest = &surface;
  }
  return newest;
}

/// Whether a challenger that was just seen replaces the surface followed: once both sensors have left that one for it,
/// or one has persistently and the other is farther or silent, longer than between its readings. A lone LiDAR outlier
/// may agree with a stereo peak: only the LiDAR's second word makes a surface farther.
bool RangeFusion::replaces(const Surface& challenger, const Filter& filter, const Reading& reading) const {
  const Surface& followed = filter.surfaces[0];
  if (!challenger.isConfirmed() || !followed.isConfirmed()) return challenger.count() > followed.count();
  const std::size_t own = sensorOf(reading), other = 1 - own;
  const bool nearer = challenger.mean[0] < followed.mean[0];
  if (challenger.seen_s[other] > followed.seen_s[other])
    return nearer || challenger.seen_s[0] - challenger.period_s[0] > followed.seen_s[0];
  const double silent_s =
      reading.stamp_s - followed.seen_s[other] - config_.lasting_s;  // more than a period is silence
  const bool held =
      silent_s <= std::min(followed.period_s[other], config_.max_gap_s) && !elsewhere(filter, other, reading.stamp_s);
  return elsewhere(filter, own, reading.stamp_s) && (nearer || !held);
}

/// Notes a reading.  @return whether it is a frozen LiDAR's: it repeats itself while the range goes on changing, or
/// stereo moves. A LiDAR that was nearer than stereo from the start is not: glass before a moving scene.
bool RangeFusion::watchRepetition(Repetition& repetition, const Surface& followed, const Reading& reading) const {
  if (reading.kind == Kind::Stereo) {
    if (std::isnan(repetition.stereo.value)) repetition.stereo = reading;
    const bool counts = !repetition.isFrozen() && reading.stamp_s - repetition.lidar.stamp_s >= config_.lasting_s;
    if (counts) repetition.moved = differ(repetition.stereo, reading) ? repetition.moved + 1 : 0;
    return false;
  }
  if (reading.value != repetition.lidar.value) {
    repetition = Repetition();
    repetition.lidar = reading;
    repetition.speed_mps = std::abs(followed.mean[1]) - std::sqrt(followed.covariance(1, 1));
  }
  ++repetition.readings;
  const double travelled_m = repetition.speed_mps * (reading.stamp_s - repetition.lidar.stamp_s);
  repetition.overdue |= travelled_m > config_.gate_sigma * std::sqrt(reading.variance_m2);
  const bool before = reading.value < repetition.stereo.value && differ(reading, repetition.stereo);
  return repetition.isFrozen() && !before;
}

bool RangeFusion::differ(const Reading& a, const Reading& b) const {
  return squared(a.value - b.value) > squared(config_.gate_sigma) * (a.variance_m2 + b.variance_m2);
}

}  // namespace flight_corridor
