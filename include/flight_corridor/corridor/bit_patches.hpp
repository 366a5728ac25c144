#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace flight_corridor {

/// An image of bits: pixel u of a row is bit u % 64 of its word u / 64.
struct BitImage {
  const std::uint64_t* first_row;
  std::ptrdiff_t step;  ///< Words from a row to the next.
  int rows, words;      ///< Words of a row.
};

/// Finds patches in images of bits: set ones that touch each other, also across corners. One object, one thread.
class BitPatches {
 public:
  /// Set bits side by side.
  struct Run {
    int v, first_u, end_u;
    int patch = 0;  ///< Alike in all runs of a patch.
  };

  /// @return the runs of all patches of so many bits or more, row by row; valid until the next call.
  const std::vector<Run>& find(const BitImage& image, double smallest_px);

 private:
  void findRuns(const std::uint64_t* row, int words, int v);
  void join(std::size_t above, std::size_t row);

  std::vector<Run> runs_, found_;
  std::vector<int> parents_, sizes_;  // a run; see rootOf()
};

}  // namespace flight_corridor
