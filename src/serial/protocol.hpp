#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace flight_corridor::serial {

enum class Protocol { Lightware, Tfmini, LidarLite };
constexpr std::array<Protocol, 3> kProtocols{Protocol::Lightware, Protocol::Tfmini, Protocol::LidarLite};

const char* toString(Protocol protocol);
/// @return nullopt for a name that no protocol has.
std::optional<Protocol> parseProtocol(const std::string& name);

/// The abilities that all LiDARs of a protocol share; parameters extend them for better sensors.
struct SensorDefaults {
  double field_of_view_rad;
  double min_range_m, max_range_m;
  double strength_min;  ///< In the sensor's unit; weaker returns are invalid.
};
SensorDefaults defaultsOf(Protocol protocol);

/// Units of distance in a protocol; the first is the usual one.
std::vector<std::string> unitsOf(Protocol protocol);
/// One of these in metres.
double metresOf(const std::string& unit);

/// Whether its readings have the return's strength.
bool hasStrength(Protocol protocol);
/// Request for one reading of a polled LiDAR; "" if the protocol has none.
std::string requestOf(Protocol protocol);

}  // namespace flight_corridor::serial
