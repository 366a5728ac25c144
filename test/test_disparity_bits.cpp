#include <gtest/gtest.h>

#include "flight_corridor/stereo/disparity_bits.hpp"

namespace flight_corridor {
namespace {

constexpr int kWords = 4;

TEST(DisparityBits, FindsTheFirstAndTheLastOnEitherSideOfAPlace) {
  std::uint64_t set[kWords] = {};
  for (const int bit : {5, 63, 64, 130, 191}) set[bit / 64] |= std::uint64_t{1} << bit % 64;
  const auto holds = [&](int place) { return set[place / 64] >> place % 64 & 1u; };
  for (int place = -70; place <= 64 * kWords + 70; ++place) {
    int first = 64 * kWords, last = -1;
    for (int bit = 0; bit < 64 * kWords; ++bit) {
      if (holds(bit) && bit >= place && first == 64 * kWords) first = bit;
      if (holds(bit) && bit <= place) last = bit;
    }
    EXPECT_EQ(firstBitFrom(set, kWords, place), first) << place;
    EXPECT_EQ(lastBitTo(set, kWords, place), last) << place;
  }
  EXPECT_EQ(firstBit(set, kWords), 5);
  EXPECT_EQ(lastBit(set, kWords), 191);
}

}  // namespace
}  // namespace flight_corridor
