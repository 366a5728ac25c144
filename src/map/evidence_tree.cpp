#include "flight_corridor/map/evidence_tree.hpp"

#include <algorithm>

namespace flight_corridor {

EvidenceTree::EvidenceTree(const MapConfig& config) : octomap::OcTree(config.resolution_m) {
  setClampingThresMin(octomap::probability(config.log_odds_min));
  setClampingThresMax(octomap::probability(config.log_odds_max));
  setProbHit(octomap::probability(config.log_odds_hit));
  setProbMiss(octomap::probability(config.log_odds_miss));
}

void EvidenceTree::add(const octomap::OcTreeKey& block, const Block<float>& log_odds) {
  const bool is_new = root == nullptr;
  if (is_new) {
    root = new octomap::OcTreeNode();
    ++tree_size;
  }
  addAbove(root, is_new, 0, block, log_odds);
}

/// Of unknown space only the path to the block is created.
void EvidenceTree::addAbove(octomap::OcTreeNode* node, bool is_new, unsigned depth, const octomap::OcTreeKey& block,
                            const Block<float>& log_odds) {
  if (depth == kBlockDepth) return addBelow(node, is_new, log_odds.data(), log_odds.size());
  if (!is_new && !nodeHasChildren(node)) expandNode(node);
  const unsigned child = octomap::computeChildIdx(block, static_cast<int>(kDepth - 1 - depth));
  const bool is_child_new = !nodeChildExists(node, child);
  addAbove(childOf(node, child), is_child_new, depth + 1, block, log_odds);
  if (!pruneNode(node)) node->updateOccupancyChildren();
}

/// A leaf stays one while the evidence of its cells is equal.
void EvidenceTree::addBelow(octomap::OcTreeNode* node, bool is_new, const float* log_odds, std::size_t cells) {
  const bool is_equal = std::equal(log_odds + 1, log_odds + cells, log_odds);
  if (is_equal && !nodeHasChildren(node)) return updateNodeLogOdds(node, *log_odds);
  if (!is_new && !nodeHasChildren(node)) expandNode(node);
  const std::size_t part = cells / 8;
  for (unsigned i = 0; i < 8; ++i) {
    const float* const begin = log_odds + i * part;
    if (std::all_of(begin, begin + part, [](float evidence) { return evidence == 0.0f; })) continue;
    const bool is_child_new = !nodeChildExists(node, i);
    addBelow(childOf(node, i), is_child_new, begin, part);
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
