#pragma once

#include <octomap/OcTree.h>

#include <array>
#include <deque>
#include <vector>

namespace flight_corridor {

/// An octomap::OcTree that takes evidence for whole cubes. The path from the root to the last cube is kept, so that
/// a neighbour costs a step or two; inner nodes are updated when the path leaves them. It owns its nodes and uses them
/// again: a map built anew for each image allocates nothing, and clearing it costs nothing. Only the methods declared
/// here may change it; those of OctoMap that do not are free.
class EvidenceTree : public octomap::OcTree {
 public:
  static constexpr unsigned kDepth = 16;    ///< Of cells; the root's is 0.
  static constexpr int kKeyOrigin = 32768;  ///< OctoMap's key of the coordinate 0.
  static constexpr int kLastKey = 65535;

  using octomap::OcTree::OcTree;
  EvidenceTree(const EvidenceTree&) = delete;
  EvidenceTree& operator=(const EvidenceTree&) = delete;
  ~EvidenceTree() override;

  /// Adds log-odds to every cell of some of a cube's children, within the clamping limits; unknown cells begin at 0.
  /// @param key any cell of the cube.
  /// @param depth of the cube, 0 = root; above the depth of cells.
  /// @param children bit i: child i of the cube.
  void addToChildren(const octomap::OcTreeKey& key, unsigned depth, unsigned children, float log_odds);

  /// Updates the inner nodes, prunes. Needed after the last evidence before the tree is read or changed otherwise.
  void settle();

  /// Makes all cells between two, corners of a box of cells, unknown.
  void forget(const octomap::OcTreeKey& low, const octomap::OcTreeKey& high);

  void clear() override;

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
  /// Sibling nodes, side by side, and OctoMap's table of those that are there.
  struct Siblings {
    octomap::AbstractOcTreeNode* children[8];
    octomap::OcTreeNode nodes[8];
  };

  void leaveUntil(unsigned depth);
  void updateInnerNode(octomap::OcTreeNode* node);
  void enter(const octomap::OcTreeKey& key, unsigned depth);
  octomap::OcTreeNode* openChild(octomap::OcTreeNode* node, unsigned child);
  void openRoot();
  void split(octomap::OcTreeNode* leaf);
  void addToChild(octomap::OcTreeNode* node, unsigned child, float log_odds);
  bool forgetIn(octomap::OcTreeNode* node, const octomap::OcTreeKey& key, unsigned depth, const octomap::OcTreeKey& low,
                const octomap::OcTreeKey& high);
  void putAwayChildren(octomap::OcTreeNode* node);
  static Siblings* siblingsOf(octomap::OcTreeNode* node);
  Siblings& takeSiblings();
  octomap::OcTreeNode* createChild(octomap::OcTreeNode* node, unsigned i);
  unsigned sharedDepth(const octomap::OcTreeKey& key, unsigned depth) const;

  std::array<octomap::OcTreeNode*, kDepth + 1> path_{};  // nodes from the root to the last cube
  octomap::OcTreeKey at_;                                // a cell of the last cube
  unsigned at_depth_ = 0;
  bool is_open_ = false;
  octomap::OcTreeNode root_node_;
  std::deque<Siblings> siblings_;  // those ever used, in the order in which a new tree takes them
  std::size_t siblings_used_ = 0;
  std::vector<Siblings*> spare_siblings_;  // used before, out of the tree
};

}  // namespace flight_corridor
