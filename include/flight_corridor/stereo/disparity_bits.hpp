#pragma once

#include <cstdint>

namespace flight_corridor {

/// Sets of disparities as bits: disparity d is bit d % 64 of word d / 64.

/// Index of the lowest set bit of a word that is not 0.
inline int lowestBit(std::uint64_t word) { return __builtin_ctzll(word); }
/// Index of the highest set bit of a word that is not 0.
inline int highestBit(std::uint64_t word) { return 63 - __builtin_clzll(word); }

/// The bits of a word whose index in the set is at least `place`.
inline std::uint64_t bitsFrom(std::uint64_t bits, int word, int place) {
  const int skipped = place - 64 * word;
  if (skipped >= 64) return 0;
  return skipped > 0 ? bits >> skipped << skipped : bits;
}

/// The bits of a word whose index in the set is at most `place`.
inline std::uint64_t bitsTo(std::uint64_t bits, int word, int place) {
  const int skipped = 63 - (place - 64 * word);
  if (skipped >= 64) return 0;
  return skipped > 0 ? bits << skipped >> skipped : bits;
}

/// The first set bit at or after an index; 64 * words without one.
inline int firstBitFrom(const std::uint64_t* set, int words, int place) {
  int first = 64 * words;
  for (int word = words - 1; word >= 0; --word) {
    const std::uint64_t bits = bitsFrom(set[word], word, place);
    if (bits != 0) first = 64 * word + lowestBit(bits);
  }
  return first;
}

/// The last set bit at or before an index; -1 without one.
inline int lastBitTo(const std::uint64_t* set, int words, int place) {
  int last = -1;
  for (int word = 0; word < words; ++word) {
    const std::uint64_t bits = bitsTo(set[word], word, place);
    if (bits != 0) last = 64 * word + highestBit(bits);
  }
  return last;
}

inline int firstBit(const std::uint64_t* set, int words) { return firstBitFrom(set, words, 0); }
inline int lastBit(const std::uint64_t* set, int words) { return lastBitTo(set, words, 64 * words - 1); }

}  // namespace flight_corridor
