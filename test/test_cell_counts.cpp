#include <gtest/gtest.h>

#include <map>
#include <random>

#include "flight_corridor/cell_counts.hpp"

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
      counts.add(cell, count);
      expected[cell] += count;
    }
    std::map<std::uint32_t, std::uint32_t> found;
    counts.forEach([&](const CellCounts::Entry& e) { EXPECT_TRUE(found.emplace(e.cell, e.count).second) << e.cell; });
    EXPECT_EQ(found, expected);
  }
}

TEST(CellCounts, KeepsTheOrderInWhichCellsCame) {
  CellCounts counts;
  for (const std::uint32_t cell : {7u, 3u, 7u, 5u}) counts.add(cell, 1);
  std::vector<std::uint32_t> cells;
  counts.forEach([&](const CellCounts::Entry& entry) { cells.push_back(entry.cell); });
  EXPECT_EQ(cells, (std::vector<std::uint32_t>{7, 3, 5}));
}

}  // namespace
}  // namespace flight_corridor
