#include <gtest/gtest.h>

#include "flight_corridor/stereo/disparity_bits.hpp"

namespace flight_corridor {
namespace {

constexpr int kWords = 4;

TEST(DisparityBits, CountsThoseBetween) {
  std::uint64_t set[kWords] = {};
  for (int bit = 0; bit < 64 * kWords; bit += 3) set[bit / 64] |= std::uint64_t{1} << bit % 64;
  for (int first = -70; first <= 64 * kWords + 70; ++first) {
    for (int last = -70; last <= 64 * kWords + 70; ++last) {
      int bits = 0;
      for (int bit = 0; bit < 64 * kWords; bit += 3) bits += first <= bit && bit <= last;
      ASSERT_EQ(bitsBetween(set, kWords, first, last), bits) << first << " " << last;
    }
  }
}

}  // namespace
}  // namespace flight_corridor
