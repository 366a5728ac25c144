#include "flight_corridor/evidence_tree.hpp"

#include <algorithm>

namespace flight_corridor {

namespace {

/// OctoMap keeps a node's table of children to itself and its descendants.
struct NodeAccess : octomap::OcTreeNode {
  static constexpr auto kChildren = &NodeAccess::children;
};

octomap::AbstractOcTreeNode**& childrenOf(octomap::OcTreeNode* node) { return node->*NodeAccess::kChildren; }

}  // namespace

EvidenceTree::~EvidenceTree() {
  for (octomap::OcTreeNode* node : spare_nodes_) delete node;
  for (octomap::AbstractOcTreeNode** table : spare_tables_) delete[] table;
}

void EvidenceTree::add(const octomap::OcTreeKey& key, unsigned depth, float log_odds) {
  const bool created = enter(key, depth);
  if (created) {
    updateNodeLogOdds(way_[depth], log_odds);
  } else {
    addToSubtree(way_[depth], log_odds);
  }
}

void EvidenceTree::settle() {
  if (!is_open_) return;
  leaveUntil(0);
  putRight(root);
  is_open_ = false;
}

/// Depth of the smallest cube that holds the last cube and another one.
unsigned EvidenceTree::sharedDepth(const octomap::OcTreeKey& key, unsigned depth) const {
  unsigned differing = (key[0] ^ at_[0]) | (key[1] ^ at_[1]) | (key[2] ^ at_[2]);
  unsigned shared = tree_depth;
  for (; differing != 0; differing >>= 1) --shared;
  return std::min({shared, depth, at_depth_});
}

/// Puts the nodes right that the way leaves: those deeper than a depth, but for the last cube, which is right.
void EvidenceTree::leaveUntil(unsigned depth) {
  if (at_depth_ <= depth) return;
  while (--at_depth_ > depth) putRight(way_[at_depth_]);
}

void EvidenceTree::putRight(octomap::OcTreeNode* node) {
  if (nodeHasChildren(node) && !pruneNode(node)) node->updateOccupancyChildren();
}

/// @return whether the cube's node is new.
bool EvidenceTree::enter(const octomap::OcTreeKey& key, unsigned depth) {
  bool created = !is_open_ && openRoot();
  leaveUntil(sharedDepth(key, depth));
  at_ = key;
  for (; at_depth_ < depth; ++at_depth_) {
    octomap::OcTreeNode* node = way_[at_depth_];
    if (!created && !nodeHasChildren(node)) expandNode(node);  // a pruned one
    const unsigned child = octomap::computeChildIdx(key, static_cast<int>(tree_depth - 1 - at_depth_));
    created = !nodeChildExists(node, child);
    way_[at_depth_ + 1] = created ? createChild(node, child) : getNodeChild(node, child);
  }
  return created;
}

/// @return whether the tree was empty.
bool EvidenceTree::openRoot() {
  const bool created = !root;
  if (created) {
    root = takeNode();
  }
  is_open_ = true;
  way_[0] = root;
  at_depth_ = 0;
  return created;
}

void EvidenceTree::forget(const octomap::OcTreeKey& low, const octomap::OcTreeKey& high) {
  settle();
  if (root && forgetIn(root, octomap::OcTreeKey(0, 0, 0), 0, low, high)) clear();
}

/// @return whether nothing is left of the node's cube.
bool EvidenceTree::forgetIn(octomap::OcTreeNode* node, const octomap::OcTreeKey& key, unsigned depth,
                            const octomap::OcTreeKey& low, const octomap::OcTreeKey& high) {
  const unsigned last_cell = (1u << (tree_depth - depth)) - 1;
  bool inside = true;
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (key[axis] > high[axis] || key[axis] + last_cell < low[axis]) return false;
    inside = inside && low[axis] <= key[axis] && key[axis] + last_cell <= high[axis];
  }
  if (inside) return true;
  if (!nodeHasChildren(node)) expandNode(node);
  for (unsigned child = 0; child < 8; ++child) {
    const octomap::OcTreeKey part = childKey(key, depth, child);
    if (nodeChildExists(node, child) && forgetIn(getNodeChild(node, child), part, depth + 1, low, high)) {
      putAway(getNodeChild(node, child));
      childrenOf(node)[child] = nullptr;
    }
  }
  putRight(node);
  return !nodeHasChildren(node);
}

void EvidenceTree::clear() {
  if (root) putAway(root);
  root = nullptr;
  is_open_ = false;
}

/// A node and what is below it leave the tree.
void EvidenceTree::putAway(octomap::OcTreeNode* node) {
  if (octomap::AbstractOcTreeNode**& children = childrenOf(node)) {
    for (unsigned i = 0; i < 8; ++i) {
      if (children[i]) putAway(getNodeChild(node, i));
    }
    spare_tables_.push_back(children);
    children = nullptr;
  }
  spare_nodes_.push_back(node);
  --tree_size;
  size_changed = true;
}

octomap::OcTreeNode* EvidenceTree::takeNode() {
  ++tree_size;
  size_changed = true;
  if (spare_nodes_.empty()) return new octomap::OcTreeNode();
  octomap::OcTreeNode* node = spare_nodes_.back();
  spare_nodes_.pop_back();
  node->setLogOdds(0.0f);
  return node;
}

octomap::OcTreeNode* EvidenceTree::createChild(octomap::OcTreeNode* node, unsigned child) {
  octomap::AbstractOcTreeNode**& children = childrenOf(node);
  if (!children) {
    if (spare_tables_.empty()) {
      children = new octomap::AbstractOcTreeNode*[8];
    } else {
      children = spare_tables_.back();
      spare_tables_.pop_back();
    }
    std::fill_n(children, 8, nullptr);
  }
  octomap::OcTreeNode* created = takeNode();
  children[child] = created;
  return created;
}

/// Unknown parts of a known subtree come into being with the evidence alone.
void EvidenceTree::addToSubtree(octomap::OcTreeNode* node, float log_odds) {
  if (!nodeHasChildren(node)) return updateNodeLogOdds(node, log_odds);
  for (unsigned child = 0; child < 8; ++child) {
    const bool known = nodeChildExists(node, child);
    addToSubtree(known ? getNodeChild(node, child) : createChild(node, child), log_odds);
  }
  putRight(node);
}

}  // namespace flight_corridor
