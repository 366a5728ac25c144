#include "flight_corridor/map/evidence_tree.hpp"

#include <algorithm>
#include <limits>
#include <type_traits>

namespace flight_corridor {

namespace {

/// OctoMap keeps a node's table of children to itself and its descendants.
struct NodeAccess : octomap::OcTreeNode {
  static constexpr auto kChildren = &NodeAccess::children;
};

octomap::AbstractOcTreeNode**& childrenOf(octomap::OcTreeNode* node) { return node->*NodeAccess::kChildren; }
bool isLeaf(const octomap::OcTreeNode* node) { return node->*NodeAccess::kChildren == nullptr; }

/// @return nullptr: there is none.
octomap::OcTreeNode* childOf(octomap::OcTreeNode* node, unsigned child) {
  octomap::AbstractOcTreeNode** children = childrenOf(node);
  return children ? static_cast<octomap::OcTreeNode*>(children[child]) : nullptr;
}

const octomap::OcTreeNode kUnknown = [] {
  octomap::OcTreeNode node;
  node.setLogOdds(-std::numeric_limits<float>::infinity());
  return node;
}();

}  // namespace

EvidenceTree::~EvidenceTree() {
  root = nullptr;  // OctoMap would delete what it did not allocate,
  childrenOf(&root_node_) = nullptr;
  for (Siblings& siblings : siblings_) {  // and insists that nodes go without children
    for (octomap::OcTreeNode& node : siblings.nodes) childrenOf(&node) = nullptr;
  }
}

void EvidenceTree::addToChildren(const octomap::OcTreeKey& key, unsigned depth, unsigned children, float log_odds) {
  enter(key, depth);
  octomap::OcTreeNode* node = path_[depth];
  for (; children != 0; children &= children - 1) addToChild(node, __builtin_ctz(children), log_odds);
}

/// Unknown parts of a known cube come into being with the evidence alone.
void EvidenceTree::addToChild(octomap::OcTreeNode* node, unsigned child, float log_odds) {
  octomap::OcTreeNode* part = childOf(node, child);
  if (!part) part = createChild(node, child);
  if (childrenOf(part)) {
    for (unsigned i = 0; i < 8; ++i) addToChild(part, i, log_odds);
    updateInnerNode(part);
  } else {
    part->setLogOdds(std::clamp(part->getLogOdds() + log_odds, clamping_thres_min, clamping_thres_max));
  }
}

void EvidenceTree::settle() {
  if (!is_open_) return;
  leaveUntil(0);
  updateInnerNode(root);
  is_open_ = false;
}

/// Depth of the smallest cube that holds the last cube and another one.
unsigned EvidenceTree::sharedDepth(const octomap::OcTreeKey& key, unsigned depth) const {
  unsigned differing = (key[0] ^ at_[0]) | (key[1] ^ at_[1]) | (key[2] ^ at_[2]);
  unsigned shared = kDepth;
  for (; differing != 0; differing >>= 1) --shared;
  return std::min({shared, depth, at_depth_});
}

/// Updates the inner nodes that the path leaves: those deeper than a depth.
void EvidenceTree::leaveUntil(unsigned depth) {
  for (; at_depth_ > depth; --at_depth_) updateInnerNode(path_[at_depth_]);
}

/// An inner node holds the most of its children; eight equal leaves become one.
void EvidenceTree::updateInnerNode(octomap::OcTreeNode* node) {
  float least = std::numeric_limits<float>::infinity(), most = -least;
  int leaves = 0;
  for (unsigned i = 0; i < 8; ++i) {
    const octomap::OcTreeNode* child = childOf(node, i);
    if (!child) child = &kUnknown;
    least = std::min(least, child->getLogOdds());
    most = std::max(most, child->getLogOdds());
    leaves += isLeaf(child);
  }
  node->setLogOdds(most);
  if (leaves == 8 && least == most) putAwayChildren(node);
}

/// Makes the path lead to a cube whose children can be changed.
void EvidenceTree::enter(const octomap::OcTreeKey& key, unsigned depth) {
  if (!is_open_) openRoot();
  leaveUntil(sharedDepth(key, depth));
  at_ = key;
  for (; at_depth_ < depth; ++at_depth_) {
    const unsigned child = octomap::computeChildIdx(key, static_cast<int>(kDepth - 1 - at_depth_));
    path_[at_depth_ + 1] = openChild(path_[at_depth_], child);
  }
}

octomap::OcTreeNode* EvidenceTree::openChild(octomap::OcTreeNode* node, unsigned child) {
  octomap::OcTreeNode* part = childOf(node, child);
  if (!part) return createChild(node, child);
  if (!childrenOf(part)) split(part);
  return part;
}

void EvidenceTree::openRoot() {
  if (!root) {
    root = &root_node_;
    root->setLogOdds(0.0f);
    childrenOf(root) = nullptr;
    tree_size = 1;
    size_changed = true;
  } else if (!childrenOf(root)) {
    split(root);
  }
  is_open_ = true;
  path_[0] = root;
  at_depth_ = 0;
}

/// A leaf, pruned or not, gets eight children like it.
void EvidenceTree::split(octomap::OcTreeNode* leaf) {
  for (unsigned i = 0; i < 8; ++i) createChild(leaf, i)->setLogOdds(leaf->getLogOdds());
}

void EvidenceTree::forget(const octomap::OcTreeKey& low, const octomap::OcTreeKey& high) {
  settle();
  if (root && forgetIn(root, octomap::OcTreeKey(0, 0, 0), 0, low, high)) clear();
}

/// @return whether nothing is left of the node's cube.
bool EvidenceTree::forgetIn(octomap::OcTreeNode* node, const octomap::OcTreeKey& key, unsigned depth,
                            const octomap::OcTreeKey& low, const octomap::OcTreeKey& high) {
  const unsigned last_cell = (1u << (kDepth - depth)) - 1;
  bool inside = true;
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (key[axis] > high[axis] || key[axis] + last_cell < low[axis]) return false;
    inside = inside && low[axis] <= key[axis] && key[axis] + last_cell <= high[axis];
  }
  if (inside) return true;
  if (!childrenOf(node)) split(node);
  for (unsigned i = 0; i < 8; ++i) {
    octomap::OcTreeNode* child = childOf(node, i);
    if (child && forgetIn(child, childKey(key, depth, i), depth + 1, low, high)) {
      putAwayChildren(child);
      childrenOf(node)[i] = nullptr;
      --tree_size;
      size_changed = true;
    }
  }
  updateInnerNode(node);
  return !nodeHasChildren(node);
}

void EvidenceTree::clear() {
  root = nullptr;
  tree_size = 0;
  size_changed = true;
  is_open_ = false;
  siblings_used_ = 0;
  spare_siblings_.clear();
}

/// What is below a node leaves the tree.
void EvidenceTree::putAwayChildren(octomap::OcTreeNode* node) {
  if (isLeaf(node)) return;
  for (unsigned i = 0; i < 8; ++i) {
    if (octomap::OcTreeNode* child = childOf(node, i)) {
      putAwayChildren(child);
      --tree_size;
    }
  }
  size_changed = true;
  spare_siblings_.push_back(siblingsOf(node));
  childrenOf(node) = nullptr;
}

/// @param node with children.
EvidenceTree::Siblings* EvidenceTree::siblingsOf(octomap::OcTreeNode* node) {
  static_assert(std::is_standard_layout<Siblings>::value, "siblings begin with their table");
  return reinterpret_cast<Siblings*>(childrenOf(node));
}

EvidenceTree::Siblings& EvidenceTree::takeSiblings() {
  if (!spare_siblings_.empty()) {
    Siblings* siblings = spare_siblings_.back();
    spare_siblings_.pop_back();
    return *siblings;
  }
  if (siblings_used_ == siblings_.size()) siblings_.emplace_back();
  return siblings_[siblings_used_++];
}

octomap::OcTreeNode* EvidenceTree::createChild(octomap::OcTreeNode* node, unsigned i) {
  if (isLeaf(node)) {
    Siblings& siblings = takeSiblings();
    std::fill_n(siblings.children, 8, nullptr);
    childrenOf(node) = siblings.children;
  }
  octomap::OcTreeNode* child = &siblingsOf(node)->nodes[i];
  child->setLogOdds(0.0f);
  childrenOf(child) = nullptr;
  childrenOf(node)[i] = child;
  ++tree_size;
  size_changed = true;
  return child;
}

}  // namespace flight_corridor
