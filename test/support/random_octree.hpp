#pragma once

#include <octomap/OcTree.h>

#include <random>

namespace flight_corridor::test_support {

inline constexpr double kResolution_m = 0.1;

/// Of a cell, counted from the origin.
inline octomap::OcTreeKey keyOf(int x, int y, int z) {
  return {static_cast<octomap::key_type>(32768 + x), static_cast<octomap::key_type>(32768 + y),
          static_cast<octomap::key_type>(32768 + z)};
}

/// A tree of random leaves, free and occupied.
inline octomap::OcTree randomTree(std::mt19937& random, int cells) {
  octomap::OcTree tree(kResolution_m);
  std::uniform_int_distribution<int> near(-30, 30);
  for (int i = 0; i < cells; ++i) {
    tree.setNodeValue(keyOf(near(random), near(random), near(random)), random() % 10 == 0 ? 1.0f : -1.0f);
  }
  return tree;
}

}  // namespace flight_corridor::test_support
