#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "flight_corridor/types.hpp"
#include "sim/random.hpp"
#include "sim/world.hpp"

namespace flight_corridor::sim {

/// A one-dimensional LiDAR: a narrow cone along +x of L.
struct LidarModel {
  double rate_hz = 100.0;  ///< 0: there is no LiDAR.
  double min_range_m = 0.2;
  double max_range_m = 100.0;
  double field_of_view_rad = 0.01;  ///< Full width of the cone.
  double noise_m = 0.02;            ///< Standard deviation.
  double drop_out_share = 0.005;    ///< Readings lost (+inf).
  double outlier_share = 0.005;     ///< Readings anywhere between nothing and 30 m.
};

/// A temporary fault, as seen on LiDARs in the field.
struct LidarFault {
  enum class Kind : std::uint8_t { None, Offset, Frozen, Zeros, Spikes, Bursts, DropOut, Silent, Slow, NotANumber };

  Kind kind = Kind::None;
  double from_s = 0.0;
  double until_s = kInfinity;
};

/// Names of LidarFault::Kind, "none" first.
std::vector<std::string> lidarFaultNames();
/// @throws std::invalid_argument naming the unknown fault and the known ones.
LidarFault::Kind lidarFaultFromName(const std::string& name);

/// Distance along +x of L to the nearest surface that fills at least a third of the cone; +inf: none [m].
double castBeam(const std::vector<Primitive>& primitives, const Eigen::Isometry3d& T_W_L, double field_of_view_rad);

/// Readings, in the order of time. Noise does not depend on the fault.
class Lidar {
 public:
  Lidar(const LidarModel& model, const LidarFault& fault, std::uint64_t seed);

  /// @param true_range_m  as castBeam() gives it.
  /// @return REP-117 reading stamped time_s; nullopt: the driver sends nothing now.
  std::optional<RangeReading> read(double true_range_m, double time_s);

 private:
  double measure(double true_range_m);
  double withinLimits(double range_m) const;
  /// The driver's value instead of a range, while the fault lasts.
  double corrupt(double range_m, double time_s);

  LidarModel model_;
  LidarFault fault_;
  Random noise_;
  Random fault_noise_;
  std::uint64_t count_ = 0;
  double last_range_m_ = kNaN;
};

}  // namespace flight_corridor::sim
