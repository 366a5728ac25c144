#pragma once

#include <octomap/OcTree.h>

namespace flight_corridor {

/// An octomap::OcTree that adds evidence to whole cubes of cells, and forgets boxes of cells.
class EvidenceTree : public octomap::OcTree {
 public:
  static constexpr unsigned kDepth = 16;    ///< Of cells; the root's is 0.
  static constexpr int kKeyOrigin = 32768;  ///< OctoMap's key of the coordinate 0.
  static constexpr int kLastKey = 65535;

  using octomap::OcTree::OcTree;

  /// Adds log-odds to every cell of a cube, within the clamping limits; unknown cells begin at 0.
  /// @param key any cell of the cube.
  /// @param depth of the cube, 0 = root.
  void add(const octomap::OcTreeKey& key, unsigned depth, float log_odds);

  /// Updates the inner nodes and prunes. Needed after adding evidence, before the tree is read or otherwise changed.
  void settle();

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
  void settle(octomap::OcTreeNode* node);
  bool forgetIn(octomap::OcTreeNode* node, const octomap::OcTreeKey& key, unsigned depth, const octomap::OcTreeKey& low,
                const octomap::OcTreeKey& high);
};

}  // namespace flight_corridor
