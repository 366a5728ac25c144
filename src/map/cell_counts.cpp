#include "flight_corridor/map/cell_counts.hpp"

#include <algorithm>

namespace flight_corridor {

void CellCounts::clear() {
  std::fill(places_.begin(), places_.end(), kNone);
  cubes_.clear();
}

CellCounts::Cube& CellCounts::append(std::uint32_t key, std::uint32_t& place) {
  place = static_cast<std::uint32_t>(cubes_.size());
  cubes_.push_back({key, {}});
  if (2 * cubes_.size() > places_.size()) grow();
  return cubes_.back();
}

void CellCounts::grow() {
  places_.assign(2 * places_.size(), kNone);
  for (std::uint32_t i = 0; i < cubes_.size(); ++i) find(cubes_[i].key) = i;
}

}  // namespace flight_corridor
