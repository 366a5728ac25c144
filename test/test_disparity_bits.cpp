#include <gtest/gtest.h>

#include "flight_corridor/stereo/disparity_bits.hpp"

namespace flight_corridor {
namespace {

constexpr int kSetWords = 4;

TEST(DisparityBits, FindsTheFirstAndTheLastOnEitherSideOfAPlace) {
  std::uint64_t set[kSetWords] = {};
  for (const int bit : {5, 63, 64, 130, 191}) set[bit / 64] |= std::uint64_t{1} << bit % 64;
  const auto holds = [&](int place) { return set[place / 64] >> place % 64 & 1u; };
  for (int place = -70; place <= 64 * kSetWords + 70; ++place) {
    int first = 64 * kSetWords, last = -1;
    for (int bit = 0; bit < 64 * kSetWords; ++bit) {
      if (holds(bit) && bit >= place && first == 64 * kSetWords) first = bit;
      if (holds(bit) && bit <= place) last = bit;
    }
    EXPECT_EQ(firstBitFrom(set, kSetWords, place), first) << place;
    EXPECT_EQ(lastBitTo(set, kSetWords, place), last) << place;
  }
  EXPECT_EQ(firstBit(set, kSetWords), 5);
  EXPECT_EQ(lastBit(set, kSetWords), 191);
}

}  // namespace
}  // namespace flight_corridor
