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

/// What every LiDAR that speaks a protocol can do; what one of them does better is a parameter's matter.
struct SensorDefaults {
  double field_of_view_rad;
  double min_range_m, max_range_m;
  double strength_min;  ///< In the sensor's unit; weaker returns are not believed.
};
SensorDefaults defaultsOf(Protocol protocol);

struct Unit {
  const char* name;
  double metres;
};
/// In which units a LiDAR that speaks a protocol may be set to give distances; the first is the usual one.
std::vector<Unit> unitsOf(Protocol protocol);

/// Whether its readings say how strong the return was.
bool hasStrength(Protocol protocol);
/// What makes a LiDAR that speaks on demand send one reading; "" where none waits to be asked.
std::string requestOf(Protocol protocol);

}  // namespace flight_corridor::serial
