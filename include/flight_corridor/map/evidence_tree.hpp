#pragma once

#include <octomap/OcTree.h>

#include <unordered_set>

namespace flight_corridor {

/// An octomap::OcTree that adds evidence to whole cubes of cells, and forgets boxes of cells.
class EvidenceTree : public octomap::OcTree {
 public:
  static constexpr unsigned kDepth = 16;    ///< Of cells; the root's is 0.
  static constexpr int kKeyOrigin = 32768;  ///< OctoMap's key of the coordinate 0.
  static constexpr int kLastKey = 65535;
  static constexpr unsigned kBlockDepth = 12;  ///< Of the blocks in which changes are noted.
  static constexpr unsigned kBlockCells = 1u << (kDepth - kBlockDepth);  ///< Along a block's edge.

  using Keys = std::unordered_set<octomap::OcTreeKey, octomap::OcTreeKey::KeyHash>;

  using octomap::OcTree::OcTree;

  /// Adds log-odds to every cell of a cube, within the clamping limits; unknown cells begin at 0.
  /// @param key any cell of the cube.
  /// @param depth of the cube, 0 = root.
  void add(const octomap::OcTreeKey& key, unsigned depth, double log_odds);

  /// Updates the inner nodes and prunes. Needed after adding evidence, before the tree is read or otherwise changed.
  void settle();

  /// Blocks that evidence was added to since it was settled, by their lowest cells.
  const Keys& changed() const { return changed_; }

  /// Makes all cells of a box unknown, given by its two corner cells.
  void forget(const octomap::OcTreeKey& low, const octomap::OcTreeKey& high);

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
  void addBelow(octomap::OcTreeNode* node, float log_odds);
  void settle(octomap::OcTreeNode* node, const octomap::OcTreeKey& key, unsigned depth);
  void noteChange(const octomap::OcTreeKey& key, unsigned depth);
  bool forgetIn(octomap::OcTreeNode* node, const octomap::OcTreeKey& key, unsigned depth, const octomap::OcTreeKey& low,
                const octomap::OcTreeKey& high);

  Keys changed_;
};

}  // namespace flight_corridor
