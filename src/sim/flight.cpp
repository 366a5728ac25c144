#include "sim/flight.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor::sim {
namespace {

/// Distance after a time when speed rises as a half cosine: the integral of speed/2 * (1 - cos(pi t / ramp)).
double distanceInRamp(double time_s, double speed_m_s, double ramp_s) {
  return speed_m_s / 2.0 * (time_s - ramp_s / M_PI * std::sin(M_PI * time_s / ramp_s));
}

double distanceFlown(const Flight& flight, double time_s) {
  const double ramp_s = std::min(flight.ramp_s, flight.duration_s / 2.0);
  const double remaining_s = flight.duration_s - time_s;
  if (time_s < ramp_s) return distanceInRamp(time_s, flight.speed_m_s, ramp_s);
  if (remaining_s >= ramp_s) return flight.speed_m_s * (time_s - ramp_s / 2.0);
  return flight.speed_m_s * (flight.duration_s - ramp_s) - distanceInRamp(remaining_s, flight.speed_m_s, ramp_s);
}

/// Two sines that never repeat together, within [-1, 1].
double oscillation(double time_s, double frequency_hz, double phase_rad) {
  const double angle = 2.0 * M_PI * frequency_hz * time_s + phase_rad;
  return 0.7 * std::sin(angle) + 0.3 * std::sin(2.3 * angle + 1.0);
}

/// Share of a manoeuvre that is done. Its speed rises and falls as a full cosine wave: no jerk at either end.
double shareDone(double from_s, double duration_s, double time_s) {
  const double share = std::clamp((time_s - from_s) / duration_s, 0.0, 1.0);
  return share - std::sin(2.0 * M_PI * share) / (2.0 * M_PI);
}

double headingIn(const Turn& turn, double time_s) {
  return turn.left_rad * shareDone(turn.from_s, turn.duration_s, time_s);
}

double headingAfter(const std::vector<Turn>& turns, double time_s) {
  double heading_rad = 0.0;
  for (const Turn& turn : turns) heading_rad += headingIn(turn, time_s);
  return heading_rad;
}

/// The line that a flight follows in the xy plane: straight between the turns, and within them summed up by Simpson's
/// rule in steps so short that the sum of all errors stays below a micrometre.
Eigen::Vector3d alongLine(const Flight& flight, double time_s) {
  constexpr double kStep_s = 0.04;
  const auto ahead = [&](double at_s) -> Eigen::Vector3d {
    const double heading_rad = headingAfter(flight.turns, at_s);
    return {std::cos(heading_rad), std::sin(heading_rad), 0.0};
  };
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  double from_s = 0.0, from_m = 0.0;
  const auto advance = [&](double to_s, const Eigen::Vector3d& direction_W) {
    const double to_m = distanceFlown(flight, to_s);
    p_W += (to_m - from_m) * direction_W;
    from_s = to_s, from_m = to_m;
  };
  for (const Turn& turn : flight.turns) {
    if (time_s <= turn.from_s) break;
    advance(turn.from_s, ahead(turn.from_s));
    const double end_s = std::min(time_s, turn.from_s + turn.duration_s);
    while (from_s < end_s) {
      const double to_s = std::min(from_s + kStep_s, end_s);
      advance(to_s, (ahead(from_s) + 4.0 * ahead((from_s + to_s) / 2.0) + ahead(to_s)) / 6.0);
    }
  }
  advance(time_s, ahead(time_s));
  return p_W;
}

/// Without sway.
Eigen::Vector3d positionAt(const Flight& flight, double time_s) {
  const double t = std::clamp(time_s, 0.0, flight.duration_s);
  Eigen::Vector3d p_W = flight.start_W + alongLine(flight, t);
  for (const Sidestep& step : flight.sidesteps) {
    p_W += shareDone(step.from_s, step.duration_s, t) * Eigen::Vector3d(0.0, step.left_m, step.up_m);
  }
  return p_W;
}

/// Turns z of W to where the thrust points that holds the body up and speeds it up.
Eigen::Quaterniond tiltAt(const Flight& flight, double time_s) {
  constexpr double kStep_s = 0.01;
  constexpr double kGravity_mps2 = 9.80665;
  const Eigen::Vector3d acceleration_W =
      (positionAt(flight, time_s - kStep_s) - 2.0 * positionAt(flight, time_s) + positionAt(flight, time_s + kStep_s)) /
      (kStep_s * kStep_s);
  return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(),
                                            acceleration_W + kGravity_mps2 * Eigen::Vector3d::UnitZ());
}

}  // namespace

Eigen::Isometry3d Flight::T_W_B(double time_s) const {
  const double t = std::clamp(time_s, 0.0, duration_s);
  const auto wave = [&](int i) { return oscillation(t, 0.4 + 0.13 * i, phase_rad + 1.7 * i); };
  Eigen::Isometry3d T_W_B = Eigen::Isometry3d::Identity();
  T_W_B.translation() = positionAt(*this, t) + sway_m.cwiseProduct(Eigen::Vector3d(wave(0), wave(1), wave(2)));
  if (tilts) T_W_B.rotate(tiltAt(*this, t));
  const double yaw_rad = headingAfter(turns, t) + headingAfter(body_yaws, t) + wobble_rad.z() * wave(3);
  T_W_B.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
               Eigen::AngleAxisd(wobble_rad.y() * wave(4), Eigen::Vector3d::UnitY()) *
               Eigen::AngleAxisd(wobble_rad.x() * wave(5), Eigen::Vector3d::UnitX()));
  return T_W_B;
}

double durationOver(double distance_m, double speed_m_s, double ramp_s) { return distance_m / speed_m_s + ramp_s; }

Turn turnAt(double from_s, double left_rad, double highest_rate_rad_s) {
  return {from_s, 2.0 * std::abs(left_rad) / highest_rate_rad_s, left_rad};
}

std::vector<Turn> yawSweep(double from_s, double until_s, double angle_rad, double highest_rate_rad_s) {
  const double across_s = turnAt(0.0, 2.0 * angle_rad, highest_rate_rad_s).duration_s;
  const int count = static_cast<int>((until_s - from_s) / across_s);
  std::vector<Turn> turns;
  double time_s = until_s - count * across_s, at_rad = 0.0;
  const auto turnTo = [&](double to_rad) {
    turns.push_back(turnAt(time_s, to_rad - at_rad, highest_rate_rad_s));
    time_s += turns.back().duration_s;
    at_rad = to_rad;
  };
  for (int i = 0; i < count; ++i) turnTo(i % 2 == 0 ? angle_rad : -angle_rad);
  if (count > 0) turnTo(0.0);
  return turns;
}

}  // namespace flight_corridor::sim
