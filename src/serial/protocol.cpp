#include "serial/protocol.hpp"

#include <algorithm>

namespace flight_corridor::serial {

const char* toString(Protocol protocol) {
  switch (protocol) {
    case Protocol::Lightware:
      return "lightware";
    case Protocol::Tfmini:
      return "tfmini";
    case Protocol::LidarLite:
      break;
  }
  return "lidar_lite";
}

std::optional<Protocol> parseProtocol(const std::string& name) {
  const auto* const found = std::find_if(kProtocols.begin(), kProtocols.end(),
                                         [&name](Protocol protocol) { return name == toString(protocol); });
  return found == kProtocols.end() ? std::nullopt : std::optional<Protocol>(*found);
}

SensorDefaults defaultsOf(Protocol protocol) {
  switch (protocol) {
    case Protocol::Lightware:  // SF11/C: 120 m, lost signal 130 m; LW20, SF20: 0.2 to 100 m, 0.3 degrees
                               // (specifications)
      return {0.0052, 0.2, 100.0, 0.0};
    case Protocol::Tfmini:  // TFmini: 0.3 to 12 m, 2.3 degrees; TF-Luna: 0.2 to 8 m, 2 degrees (3.4); strength 100
                            // (5.4)
      return {0.040, 0.3, 8.0, 100.0};
    case Protocol::LidarLite:  // v3 and v3HP: 0.05 to 40 m, 8 mrad; the sensor judges its returns itself
      break;
  }
  return {0.008, 0.05, 40.0, 0.0};
}

std::vector<std::string> unitsOf(Protocol protocol) {
  switch (protocol) {
    case Protocol::Lightware:
      return {"m"};
    case Protocol::Tfmini:  // TFmini Plus, TF-Luna: output format 1, 6
      return {"cm", "mm"};
    case Protocol::LidarLite:
      break;
  }
  return {"cm"};
}

double metresOf(const std::string& unit) { return unit == "mm" ? 0.001 : unit == "cm" ? 0.01 : 1.0; }

bool hasStrength(Protocol protocol) { return protocol != Protocol::Lightware; }

std::string requestOf(Protocol protocol) { return protocol == Protocol::Lightware ? "d" : ""; }

}  // namespace flight_corridor::serial
