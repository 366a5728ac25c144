#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

#include "serial/protocol.hpp"

namespace flight_corridor::serial::test_support {

/// What a TFmini sends.
inline std::string tfminiFrame(unsigned distance_cm, unsigned strength, unsigned temperature = 2456) {
  std::string frame = "\x59\x59";
  for (const unsigned word : {distance_cm, strength, temperature}) {
    frame.push_back(static_cast<char>(word & 0xff));
    frame.push_back(static_cast<char>(word >> 8));
  }
  unsigned sum = 0;
  for (const char byte : frame) sum += static_cast<std::uint8_t>(byte);
  frame.push_back(static_cast<char>(sum & 0xff));
  return frame;
}

/// The line with its checksum.
inline std::string lidarLiteLine(const std::string& body) {
  unsigned sum = 0;
  for (const char byte : body) sum ^= static_cast<std::uint8_t>(byte);
  char checksum[8];
  std::snprintf(checksum, sizeof checksum, "*%02X\r\n", sum & 0xff);
  return body + checksum;
}

inline std::string lightwareLine(unsigned distance_cm) {
  char line[32];
  std::snprintf(line, sizeof line, "%u.%02u\r\n", distance_cm / 100, distance_cm % 100);
  return line;
}

/// What a LiDAR sends of a distance, the return strong.
inline std::string wireBytes(Protocol protocol, unsigned distance_cm) {
  if (protocol == Protocol::Tfmini) return tfminiFrame(distance_cm, 1000);
  if (protocol == Protocol::Lightware) return lightwareLine(distance_cm);
  return lidarLiteLine("R," + std::to_string(distance_cm) + ",120");
}

/// What brings a reader of a stream in step: of what came before it knows nothing.
inline std::string lead(Protocol protocol) { return protocol == Protocol::Tfmini ? tfminiFrame(100, 1000) : "\n"; }

}  // namespace flight_corridor::serial::test_support
