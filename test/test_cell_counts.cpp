#include <gtest/gtest.h>

#include <map>
#include <random>

#include "flight_corridor/map/cell_counts.hpp"

namespace flight_corridor {
namespace {

TEST(CellCounts, AgreesWithAMapAcrossGrowthAndClearing) {
  std::mt19937_64 random(5);
  CellCounts counts;
  for (const int cells : {10, 5000, 300}) {
    counts.clear();
    std::map<std::uint32_t, std::uint32_t> expected;
    for (int i = 0; i < 4 * cells; ++i) {
      const auto cell = static_cast<std::uint32_t>(random() % cells << (random() % 2 * 17));  // clustered and scattered
      const auto count = static_cast<std::uint32_t>(1 + random() % 7);
      counts.add(cell / 8, cell % 8, count);
      expected[cell] += count;
    }
    std::map<std::uint32_t, std::uint32_t> found;
    for (const CellCounts::Cube& cube : counts.cubes()) {
      for (std::uint32_t cell = 0; cell < 8; ++cell) {
        if (cube.counts[cell] == 0) continue;
        EXPECT_TRUE(found.emplace(8 * cube.key + cell, cube.counts[cell]).second) << cube.key;
      }
    }
    EXPECT_EQ(found, expected);
  }
}

TEST(CellCounts, KeepsTheOrderInWhichCubesCame) {
  CellCounts counts;
  for (const std::uint32_t cube : {7u, 3u, 7u, 5u}) counts.add(cube, 0, 1);
  std::vector<std::uint32_t> cubes;
  for (const CellCounts::Cube& cube : counts.cubes()) cubes.push_back(cube.key);
  EXPECT_EQ(cubes, (std::vector<std::uint32_t>{7, 3, 5}));
}

}  // namespace
}  // namespace flight_corridor
