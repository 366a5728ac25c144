#include "flight_corridor/map/evidence_tree.hpp"

namespace flight_corridor {

/// A pruned leaf on the path gets eight equal children; in unknown space only the path is created.
void EvidenceTree::add(const octomap::OcTreeKey& key, unsigned depth, double log_odds) {
  bool is_new = root == nullptr;
  if (is_new) {
    root = new octomap::OcTreeNode();
    ++tree_size;
  }
  octomap::OcTreeNode* node = root;
  for (unsigned i = 0; i < depth; ++i) {
    if (!is_new && !nodeHasChildren(node)) expandNode(node);
    const unsigned child = octomap::computeChildIdx(key, static_cast<int>(kDepth - 1 - i));
    is_new = !nodeChildExists(node, child);
    node = is_new ? createNodeChild(node, child) : getNodeChild(node, child);
  }
  addBelow(node, static_cast<float>(log_odds));
  noteChange(key, depth);
}

/// Of a cube's blocks, or of the block that it is part of.
void EvidenceTree::noteChange(const octomap::OcTreeKey& key, unsigned depth) {
  const unsigned edge = 1u << (kDepth - depth);
  const auto lowest = [](unsigned cell) { return static_cast<octomap::key_type>(cell & ~(kBlockCells - 1)); };
  for (unsigned x = 0; x < edge; x += kBlockCells) {
    for (unsigned y = 0; y < edge; y += kBlockCells) {
      for (unsigned z = 0; z < edge; z += kBlockCells) {
        changed_.insert({lowest(key[0] + x), lowest(key[1] + y), lowest(key[2] + z)});
      }
    }
  }
}

/// Unknown parts of a known cube come into being with the evidence alone.
void EvidenceTree::addBelow(octomap::OcTreeNode* node, float log_odds) {
  if (!nodeHasChildren(node)) return updateNodeLogOdds(node, log_odds);
  for (unsigned i = 0; i < 8; ++i) {
    addBelow(nodeChildExists(node, i) ? getNodeChild(node, i) : createNodeChild(node, i), log_odds);
  }
}

void EvidenceTree::settle() {
  if (root) settle(root, {0, 0, 0}, 0);
  changed_.clear();
}

/// An inner node holds the most of its children; eight equal leaves become one. Blocks that did not change are settled.
void EvidenceTree::settle(octomap::OcTreeNode* node, const octomap::OcTreeKey& key, unsigned depth) {
  if (!nodeHasChildren(node) || (depth == kBlockDepth && changed_.count(key) == 0)) return;
  for (unsigned i = 0; i < 8; ++i) {
    if (nodeChildExists(node, i)) settle(getNodeChild(node, i), childKey(key, depth, i), depth + 1);
  }
  if (!pruneNode(node)) node->updateOccupancyChildren();
}

void EvidenceTree::forget(const octomap::OcTreeKey& low, const octomap::OcTreeKey& high) {
  if (root && forgetIn(root, octomap::OcTreeKey(0, 0, 0), 0, low, high)) clear();
}

/// Needs inner nodes that are up to date, and leaves them so.
/// @return whether the node's cube is empty: the node is then a leaf to be deleted.
bool EvidenceTree::forgetIn(octomap::OcTreeNode* node, const octomap::OcTreeKey& key, unsigned depth,
                            const octomap::OcTreeKey& low, const octomap::OcTreeKey& high) {
  const unsigned last_cell = (1u << (kDepth - depth)) - 1;
  bool inside = true;
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (key[axis] > high[axis] || key[axis] + last_cell < low[axis]) return false;
    inside = inside && low[axis] <= key[axis] && key[axis] + last_cell <= high[axis];
  }
  if (!nodeHasChildren(node)) {
    if (inside) return true;
    expandNode(node);
  }
  for (unsigned i = 0; i < 8; ++i) {
    if (nodeChildExists(node, i) && forgetIn(getNodeChild(node, i), childKey(key, depth, i), depth + 1, low, high)) {
      deleteNodeChild(node, i);
    }
  }
  if (nodeHasChildren(node)) {
    node->updateOccupancyChildren();
    return false;
  }
  expandNode(node);  // OctoMap frees the table of a node's children only when it prunes them
  pruneNode(node);
  return true;
}

}  // namespace flight_corridor
