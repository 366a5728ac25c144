#include "flight_corridor/map/map_config.hpp"

#include "flight_corridor/map/evidence_tree.hpp"

namespace flight_corridor {

double mapReach(const MapConfig& config) { return EvidenceTree::kKeyOrigin * config.resolution_m; }

double farthestCamera(const MapConfig& config) { return mapReach(config) - config.max_range_m; }

}  // namespace flight_corridor
