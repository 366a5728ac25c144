#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace flight_corridor {

/// How many points each cell holds, by cubes of eight cells, as an octree's last inner
/// nodes hold them. Open addressing: no allocation once it has held as many cubes before.
class CellCounts {
 public:
  /// Counts of the eight cells of a cube.
  struct Cube {
    std::uint32_t key;
    std::array<std::uint32_t, 8> counts;
  };

  void clear();
  void add(std::uint32_t cube, unsigned cell, std::uint32_t count) { at(cube).counts[cell] += count; }

  /// In the order in which they came.
  const std::vector<Cube>& cubes() const { return cubes_; }

 private:
  Cube& at(std::uint32_t key) {
    std::uint32_t& place = find(key);
    return place == kNone ? append(key, place) : cubes_[place];
  }

  /// The place of a cube, or the empty one where it belongs (Fibonacci hashing, linear probing).
  std::uint32_t& find(std::uint32_t key) {
    const auto mask = static_cast<std::uint32_t>(places_.size() - 1);
    auto i = static_cast<std::uint32_t>(key * 0x9E3779B97F4A7C15u >> 32) & mask;
    while (places_[i] != kNone && cubes_[places_[i]].key != key) i = (i + 1) & mask;
    return places_[i];
  }

  Cube& append(std::uint32_t key, std::uint32_t& place);
  void grow();

  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::vector<std::uint32_t> places_ = std::vector<std::uint32_t>(1024, kNone);  // indices of cubes_
  std::vector<Cube> cubes_;
};

}  // namespace flight_corridor
