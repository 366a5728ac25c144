#pragma once

#include <string>

namespace flight_corridor::tools {

/// Follows the records of a bag (format 2.0) and the lengths that they announce: rosbag believes these, and reads
/// beyond its memory where a damaged bag's are wrong. Compressed chunks carry checksums, so that they are not opened.
/// @throws std::runtime_error with the fault and its byte.
void requireSoundRecords(const std::string& path);

}  // namespace flight_corridor::tools
