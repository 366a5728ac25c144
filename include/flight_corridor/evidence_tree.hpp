#pragma once

#include <octomap/OcTree.h>

#include <array>
#include <vector>

namespace flight_corridor {

/// An octomap::OcTree that takes evidence for whole cubes. The way from the root to the last cube is kept, so that a
/// neighbour costs a step or two; inner nodes are put right when the way leaves them. Nodes that leave the tree are
/// kept for the next ones: a map built anew for each image allocates nothing.
class EvidenceTree : public octomap::OcTree {
 public:
  using octomap::OcTree::OcTree;
  EvidenceTree(const EvidenceTree&) = delete;
  EvidenceTree& operator=(const EvidenceTree&) = delete;
  ~EvidenceTree() override;

  /// Adds log-odds to every cell of a cube, within the clamping limits; unknown cells begin at 0.
  /// @param key any cell of the cube.
  /// @param depth of the cube, 0 = root.
  void add(const octomap::OcTreeKey& key, unsigned depth, float log_odds);

  /// Puts the inner nodes right, prunes. Needed after the last add() before the tree is read or changed otherwise.
  void settle();

  /// Makes all cells between two, corners of a box of cells, unknown.
  void forget(const octomap::OcTreeKey& low, const octomap::OcTreeKey& high);

  void clear() override;

  /// Key of the lowest cell of a cube's child.
  /// @param key, depth  of the cube: its lowest cell, its depth.
  octomap::OcTreeKey childKey(octomap::OcTreeKey key, unsigned depth, unsigned child) const {
    const unsigned half = 1u << (tree_depth - depth - 1);
    for (unsigned axis = 0; axis < 3; ++axis) {
      if (child >> axis & 1u) key[axis] = static_cast<octomap::key_type>(key[axis] + half);
    }
    return key;
  }

 private:
  void leaveUntil(unsigned depth);
  void putRight(octomap::OcTreeNode* node);
  bool enter(const octomap::OcTreeKey& key, unsigned depth);
  bool openRoot();
  void addToSubtree(octomap::OcTreeNode* node, float log_odds);
  bool forgetIn(octomap::OcTreeNode* node, const octomap::OcTreeKey& key, unsigned depth, const octomap::OcTreeKey& low,
                const octomap::OcTreeKey& high);
  void putAway(octomap::OcTreeNode* node);
  octomap::OcTreeNode* takeNode();
  octomap::OcTreeNode* createChild(octomap::OcTreeNode* node, unsigned child);
  unsigned sharedDepth(const octomap::OcTreeKey& key, unsigned depth) const;

  std::array<octomap::OcTreeNode*, 17> way_{};  // nodes from the root to the last cube
  octomap::OcTreeKey at_;                       // a cell of the last cube
  unsigned at_depth_ = 0;
  bool is_open_ = false;
  std::vector<octomap::OcTreeNode*> spare_nodes_;
  std::vector<octomap::AbstractOcTreeNode**> spare_tables_;
};

}  // namespace flight_corridor
