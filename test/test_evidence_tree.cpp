#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <tuple>

#include "flight_corridor/map/evidence_tree.hpp"

namespace flight_corridor {
namespace {

constexpr unsigned kLeaf = 16;
constexpr unsigned kSide = 16;              // cells of the corner of the octree that the tests fill
constexpr unsigned short kLow = 32768 - 5;  // not at a coarse cube's border

/// One value for each cell, changed one by one.
using CellValues = std::map<std::tuple<int, int, int>, float>;

octomap::OcTreeKey key(unsigned x, unsigned y, unsigned z) {
  return octomap::OcTreeKey(static_cast<octomap::key_type>(kLow + x), static_cast<octomap::key_type>(kLow + y),
                            static_cast<octomap::key_type>(kLow + z));
}

template <class Visit>
void forEachCell(const Visit& visit) {
  for (unsigned x = 0; x < kSide; ++x) {
    for (unsigned y = 0; y < kSide; ++y) {
      for (unsigned z = 0; z < kSide; ++z) visit(key(x, y, z));
    }
  }
}

bool isInCube(const octomap::OcTreeKey& cell, const octomap::OcTreeKey& cube, unsigned depth) {
  const unsigned shift = kLeaf - depth;
  return cell[0] >> shift == cube[0] >> shift && cell[1] >> shift == cube[1] >> shift &&
         cell[2] >> shift == cube[2] >> shift;
}

void addTo(CellValues& cells, const octomap::OcTreeKey& cube, unsigned depth, float log_odds) {
  forEachCell([&](const octomap::OcTreeKey& cell) {
    if (!isInCube(cell, cube, depth)) return;
    float& value = cells[{cell[0], cell[1], cell[2]}];
    value = std::clamp(value + log_odds, -2.0f, 3.5f);
  });
}

void forget(CellValues& cells, const octomap::OcTreeKey& low, const octomap::OcTreeKey& high) {
  forEachCell([&](const octomap::OcTreeKey& cell) {
    for (int axis = 0; axis < 3; ++axis) {
      if (cell[axis] < low[axis] || cell[axis] > high[axis]) return;
    }
    cells.erase({cell[0], cell[1], cell[2]});
  });
}

void expectEqual(const EvidenceTree& tree, const CellValues& cells) {
  forEachCell([&](const octomap::OcTreeKey& cell) {
    const auto expected = cells.find({cell[0], cell[1], cell[2]});
    const octomap::OcTreeNode* node = tree.search(cell);
    ASSERT_EQ(node != nullptr, expected != cells.end());
    if (node) {
      ASSERT_NEAR(node->getLogOdds(), expected->second, 1e-5f);
    }
  });
  octomap::OcTree rebuilt(tree);
  rebuilt.updateInnerOccupancy();
  rebuilt.prune();
  EXPECT_EQ(rebuilt, tree) << "inner nodes are not right";
  EXPECT_EQ(tree.size(), tree.calcNumNodes());
}

class AnEvidenceTree : public ::testing::Test {
 protected:
  static MapConfig config() {
    MapConfig config;
    config.log_odds_min = -2.0;
    config.log_odds_max = 3.5;
    return config;
  }

  /// Evidence for a cube of cells that is no larger than a block.
  void add(const octomap::OcTreeKey& cube, unsigned depth, float log_odds) {
    EvidenceTree::Block<float> block{};
    const unsigned edge = 1u << (kLeaf - depth);
    const auto low = [&](unsigned axis) { return cube[axis] % EvidenceTree::kBlockCells / edge * edge; };
    for (unsigned x = 0; x < edge; ++x) {
      for (unsigned y = 0; y < edge; ++y) {
        for (unsigned z = 0; z < edge; ++z) {
          block[EvidenceTree::cellInBlock(low(0) + x, low(1) + y, low(2) + z)] = log_odds;
        }
      }
    }
    tree_.add(EvidenceTree::blockOf(cube), block);
  }

  unsigned below(unsigned count) { return static_cast<unsigned>(random_() % count); }
  octomap::OcTreeKey anyCell() {
    const unsigned x = below(kSide), y = below(kSide), z = below(kSide);
    return key(x, y, z);
  }

  std::mt19937 random_{17};
  EvidenceTree tree_{config()};
};

TEST_F(AnEvidenceTree, AgreesWithCellsThatAreChangedOneByOne) {
  CellValues cells;
  for (int round = 0; round < 40; ++round) {
    for (int i = 0; i < 60; ++i) {
      const octomap::OcTreeKey cube = anyCell();
      const unsigned depth = kLeaf - below(5);
      const float log_odds = below(2) ? 2.0f : -0.7f;
      add(cube, depth, log_odds);
      addTo(cells, cube, depth, log_odds);
    }
    expectEqual(tree_, cells);
    octomap::OcTreeKey low = anyCell(), high = anyCell();
    for (int axis = 0; axis < 3; ++axis) {
      if (low[axis] > high[axis]) std::swap(low[axis], high[axis]);
    }
    tree_.forget(low, high);
    forget(cells, low, high);
    expectEqual(tree_, cells);
    if (HasFatalFailure()) return;
  }
}

TEST_F(AnEvidenceTree, EightEqualCellsAreOneNode) {
  for (unsigned i = 0; i < 8; ++i) add(EvidenceTree::childKey(key(5, 5, 5), 15, i), kLeaf, 2.0f);
  unsigned depth = 0;
  ASSERT_NE(tree_.search(key(5, 5, 5)), nullptr);
  for (auto leaf = tree_.begin_leafs(); leaf != tree_.end_leafs(); ++leaf) depth = leaf.getDepth();
  EXPECT_EQ(tree_.getNumLeafNodes(), 1u);
  EXPECT_EQ(depth, 15u);
}

TEST_F(AnEvidenceTree, ForgettingAllOfItLeavesNothing) {
  tree_.forget(key(0, 0, 0), key(9, 9, 9));  // of an empty tree: no harm
  add(key(3, 3, 3), kLeaf, 2.0f);
  add(key(8, 3, 3), 14, -0.7f);
  tree_.forget(octomap::OcTreeKey(0, 0, 0), octomap::OcTreeKey(65535, 65535, 65535));
  EXPECT_EQ(tree_.size(), 0u);
  EXPECT_EQ(tree_.getRoot(), nullptr);
  add(key(3, 3, 3), kLeaf, 2.0f);
  EXPECT_EQ(tree_.size(), 17u);
}

TEST_F(AnEvidenceTree, ForgettingACellMovesTheTreesBounds) {
  add(key(0, 3, 3), kLeaf, 2.0f);
  add(key(9, 3, 3), kLeaf, 2.0f);
  const auto highest = [this] {
    double x, y, z;
    tree_.getMetricMax(x, y, z);
    return x;
  };
  const double before = highest();
  tree_.forget(key(9, 3, 3), key(9, 3, 3));
  EXPECT_NEAR(highest(), before - 9 * tree_.getResolution(), 1e-6);
}

}  // namespace
}  // namespace flight_corridor
