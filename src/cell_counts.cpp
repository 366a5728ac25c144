#include "flight_corridor/cell_counts.hpp"

#include <algorithm>

namespace flight_corridor {

void CellCounts::clear() {
  std::fill(places_.begin(), places_.end(), Entry{0, 0});
  order_.clear();
}

void CellCounts::add(std::uint32_t cell, std::uint32_t count) {
  const std::uint32_t place = find(cell);
  const bool is_new = places_[place].count == 0;
  places_[place].cell = cell;
  places_[place].count += count;
  if (!is_new) return;
  order_.push_back(place);
  if (2 * order_.size() > places_.size()) grow();
}

/// The place of a cell, or the empty one where it belongs (Fibonacci hashing, linear probing).
std::uint32_t CellCounts::find(std::uint32_t cell) const {
  const auto mask = static_cast<std::uint32_t>(places_.size() - 1);
  auto place = static_cast<std::uint32_t>(cell * 0x9E3779B97F4A7C15u >> 32) & mask;
  while (places_[place].count != 0 && places_[place].cell != cell) place = (place + 1) & mask;
  return place;
}

void CellCounts::grow() {
  const std::vector<Entry> full = std::move(places_);
  places_.assign(2 * full.size(), Entry{0, 0});
  for (std::uint32_t& place : order_) {
    const Entry entry = full[place];
    place = find(entry.cell);
    places_[place] = entry;
  }
}

}  // namespace flight_corridor
