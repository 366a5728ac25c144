#include "flight_corridor/corridor/bit_patches.hpp"

#include "flight_corridor/disjoint_sets.hpp"
#include "flight_corridor/stereo/disparity_bits.hpp"

namespace flight_corridor {

const std::vector<BitPatches::Run>& BitPatches::find(const BitImage& image, double smallest_px) {
  runs_.clear();
  parents_.clear();
  found_.clear();
  std::size_t above = 0;
  for (int v = 0; v < image.rows; ++v) {
    const std::size_t row = runs_.size();
    findRuns(image.first_row + v * image.step, image.words, v);
    join(above, row);
    above = row;
  }
  sizes_.assign(runs_.size(), 0);
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    sizes_[rootOf(parents_, static_cast<int>(i))] += runs_[i].end_u - runs_[i].first_u;
  }
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    const int patch = rootOf(parents_, static_cast<int>(i));
    if (sizes_[patch] >= smallest_px) found_.push_back({runs_[i].v, runs_[i].first_u, runs_[i].end_u, patch});
  }
  return found_;
}

void BitPatches::findRuns(const std::uint64_t* row, int words, int v) {
  const std::size_t first = runs_.size();
  for (int word = 0; word < words; ++word) {
    for (std::uint64_t bits = row[word]; bits != 0;) {
      const std::uint64_t behind = bits + (bits & -bits);  // the lowest run is carried to the bit behind it
      const int first_u = 64 * word + lowestBit(bits),
                end_u = behind != 0 ? 64 * word + lowestBit(behind) : 64 * (word + 1);
      bits &= behind;
      if (runs_.size() > first && runs_.back().end_u == first_u) {
        runs_.back().end_u = end_u;
      } else {
        runs_.push_back({v, first_u, end_u});
        parents_.push_back(static_cast<int>(parents_.size()));
      }
    }
  }
}

/// The runs from `row` on with those of the row above.
void BitPatches::join(std::size_t above, std::size_t row) {
  for (std::size_t i = above, j = row; i < row && j < runs_.size();) {
    if (runs_[i].first_u <= runs_[j].end_u && runs_[j].first_u <= runs_[i].end_u) {
      parents_[rootOf(parents_, static_cast<int>(i))] = rootOf(parents_, static_cast<int>(j));
    }
    runs_[i].end_u < runs_[j].end_u ? ++i : ++j;
  }
}

}  // namespace flight_corridor
