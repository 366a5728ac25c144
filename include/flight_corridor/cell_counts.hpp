#pragma once

#include <cstdint>
#include <vector>

namespace flight_corridor {

/// How often each cell was counted. Open addressing: no allocation once it has held as many cells before.
class CellCounts {
 public:
  struct Entry {
    std::uint32_t cell;
    std::uint32_t count;  // 0 = the place is empty
  };

  void clear();
  /// @param count 1 or more.
  void add(std::uint32_t cell, std::uint32_t count);

  /// Calls visit(entry) for each cell, in the order in which they came.
  template <class Visit>
  void forEach(const Visit& visit) const {
    for (const std::uint32_t place : order_) visit(places_[place]);
  }

 private:
  std::uint32_t find(std::uint32_t cell) const;
  void grow();

  std::vector<Entry> places_ = std::vector<Entry>(1024, Entry{0, 0});
  std::vector<std::uint32_t> order_;  // places in the order in which they were filled
};

}  // namespace flight_corridor
