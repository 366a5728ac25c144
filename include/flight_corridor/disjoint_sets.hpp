#pragma once

#include <vector>

namespace flight_corridor {

/// The root label of a set of joined labels.
/// @param parents of each label: another of its set, or itself if it is the root; paths are shortened.
inline int rootOf(std::vector<int>& parents, int label) {
  while (parents[label] != label) label = parents[label] = parents[parents[label]];
  return label;
}

}  // namespace flight_corridor
