#pragma once

#include <octomap/OcTree.h>

#include <string>

namespace flight_corridor::tools {

/// Writes an octree as OctoMap's tools read it: F.ot with the cells' log-odds, F.bt with free, occupied and unknown
/// only.
/// @throws CLI::ValidationError for another extension; std::runtime_error naming the file when it cannot be written.
void writeMap(const std::string& path, const octomap::OcTree& tree);

}  // namespace flight_corridor::tools
