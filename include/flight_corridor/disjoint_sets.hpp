#pragma once

#include <vector>

namespace flight_corridor {

/// The label that stands for a set of joined labels. @param parents of each label: another of its set, or itself where
/// it stands for the set; ways to it become shorter.
inline int rootOf(std::vector<int>& parents, int label) {
  while (parents[label] != label) label = parents[label] = parents[parents[label]];
  return label;
}

}  // namespace flight_corridor
