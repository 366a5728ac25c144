#pragma once

#include <octomap/OcTree.h>

#include <array>

#include "flight_corridor/map/map_config.hpp"

namespace flight_corridor {

/// An octomap::OcTree that adds evidence to blocks of cells, and forgets boxes of cells.
class EvidenceTree : public octomap::OcTree {
 public:
  static constexpr unsigned kDepth = 16;    ///< Of cells; the root's is 0.
  static constexpr int kKeyOrigin = 32768;  ///< OctoMap's key of the coordinate 0.
  static constexpr int kLastKey = 65535;
  static constexpr unsigned kBlockDepth = 12;
  static constexpr unsigned kBlockCells = 1u << (kDepth - kBlockDepth);  ///< Along a block's edge.

  /// Something of each cell of a block, at cellInBlock().
  template <typename T>
  using Block = std::array<T, kBlockCells * kBlockCells * kBlockCells>;

  /// With the resolution, log-odds and limits of a map.
  explicit EvidenceTree(const MapConfig& config);

  /// Adds log-odds to the cells of a block, within the clamping limits; unknown cells begin at 0.
  /// @param block its lowest cell.
  /// @param log_odds 0: no evidence, the cell stays as it is.
  void add(const octomap::OcTreeKey& block, const Block<float>& log_odds);

  /// Makes all cells of a box unknown, given by its two corner cells.
  void forget(const octomap::OcTreeKey& low, const octomap::OcTreeKey& high);

  /// The lowest cell of a cell's block.
  static octomap::OcTreeKey blockOf(const octomap::OcTreeKey& cell) {
    const auto lowest = [](unsigned key) { return static_cast<octomap::key_type>(key & ~(kBlockCells - 1)); };
    return {lowest(cell[0]), lowest(cell[1]), lowest(cell[2])};
  }

  /// Where a cell stands in its block, in the order of the octree's children: the cells of a cube are successive.
  static unsigned cellInBlock(unsigned x, unsigned y, unsigned z) {
    return spread(x) | spread(y) << 1 | spread(z) << 2;
  }

  /// Key of the lowest cell of a cube's child.
  /// @param key, depth  of the cube: its lowest cell, its depth.
  static octomap::OcTreeKey childKey(octomap::OcTreeKey key, unsigned depth, unsigned child) {
    const unsigned half = 1u << (kDepth - depth - 1);
    for (unsigned axis = 0; axis < 3; ++axis) {
      if (child >> axis & 1u) key[axis] = static_cast<octomap::key_type>(key[axis] + half);
    }
    return key;
  }

 private:
  /// The bits of a place along a block's edge, two apart.
  static unsigned spread(unsigned n) { return (n & 1u) | (n & 2u) << 2 | (n & 4u) << 4 | (n & 8u) << 6; }

  void addAbove(octomap::OcTreeNode* node, bool is_new, unsigned depth, const octomap::OcTreeKey& block,
                const Block<float>& log_odds);
  void addBelow(octomap::OcTreeNode* node, bool is_new, const float* log_odds, std::size_t cells);
  octomap::OcTreeNode* childOf(octomap::OcTreeNode* node, unsigned child) {
    return nodeChildExists(node, child) ? getNodeChild(node, child) : createNodeChild(node, child);
  }
  bool forgetIn(octomap::OcTreeNode* node, const octomap::OcTreeKey& key, unsigned depth, const octomap::OcTreeKey& low,
                const octomap::OcTreeKey& high);
};

}  // namespace flight_corridor
