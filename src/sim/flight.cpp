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

/// Speed rises and falls as a full cosine wave: no jerk at either end.
double shiftedLeft(const Sidestep& sidestep, double time_s) {
  const double share = std::clamp((time_s - sidestep.from_s) / sidestep.duration_s, 0.0, 1.0);
  return sidestep.left_m * (share - std::sin(2.0 * M_PI * share) / (2.0 * M_PI));
}

}  // namespace

Eigen::Isometry3d Flight::T_W_B(double time_s) const {
  const double t = std::clamp(time_s, 0.0, duration_s);
  const auto wave = [&](int i) { return oscillation(t, 0.4 + 0.13 * i, phase_rad + 1.7 * i); };
  Eigen::Isometry3d T_W_B = Eigen::Isometry3d::Identity();
  T_W_B.translation() = start_W + Eigen::Vector3d(distanceFlown(*this, t), 0.0, 0.0) +
                        sway_m.cwiseProduct(Eigen::Vector3d(wave(0), wave(1), wave(2)));
  for (const Sidestep& sidestep : sidesteps) T_W_B.translation().y() += shiftedLeft(sidestep, t);
  T_W_B.linear() = (Eigen::AngleAxisd(wobble_rad.z() * wave(3), Eigen::Vector3d::UnitZ()) *
                    Eigen::AngleAxisd(wobble_rad.y() * wave(4), Eigen::Vector3d::UnitY()) *
                    Eigen::AngleAxisd(wobble_rad.x() * wave(5), Eigen::Vector3d::UnitX()))
                       .toRotationMatrix();
  return T_W_B;
}

double durationOver(double distance_m, double speed_m_s, double ramp_s) { return distance_m / speed_m_s + ramp_s; }

}  // namespace flight_corridor::sim
