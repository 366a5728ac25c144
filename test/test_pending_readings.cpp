#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "flight_corridor/range/pending_readings.hpp"

namespace flight_corridor {
namespace {

using Pending = PendingReadings<int>;

TEST(PendingReadings, EachWaitsForThePairThatIsNotBeforeIt) {
  Pending readings;
  readings.take(0.9);
  readings.put(1.2, 3);
  readings.put(1.0, 1);
  readings.put(1.1, 2);
  EXPECT_EQ(readings.take(1.0), std::vector<int>{1});
  EXPECT_EQ(readings.take(1.05), std::vector<int>{});
  EXPECT_EQ(readings.take(1.2), (std::vector<int>{3, 2})) << "in the order of arrival";
  EXPECT_EQ(readings.refused(), 0u);
}

TEST(PendingReadings, AnImpossibleStampIsRefusedWithItsDifference) {
  for (const double wrong_s : {0.0, 50.0, 98.9, 3700.0, kNaN, kInfinity, -kInfinity}) {
    Pending readings;
    readings.take(100.0);
    readings.put(wrong_s, 1);
    readings.put(100.1, 2);
    EXPECT_EQ(readings.take(100.1), std::vector<int>{2}) << wrong_s;
    EXPECT_EQ(readings.refused(), 1u) << wrong_s;
    EXPECT_TRUE(std::isnan(wrong_s) ? std::isnan(readings.refusedDifference())
                                    : readings.refusedDifference() == wrong_s - 100.1);
  }
}

TEST(PendingReadings, ALateOneIsTaken) {
  Pending readings;
  readings.take(100.0);
  readings.put(99.2, 1);
  EXPECT_EQ(readings.take(100.1).size(), 1u);
}

TEST(PendingReadings, ThoseOfAPauseOfTheCamerasAreNotTooOld) {
  Pending readings;
  readings.take(100.0);
  for (int i = 1; i <= 100; ++i) readings.put(100.0 + 0.1 * i, i);
  EXPECT_EQ(readings.take(110.0).size(), 100u);
  EXPECT_EQ(readings.refused(), 0u);
}

TEST(PendingReadings, OfAnotherTimeTheyGoWithoutAWord) {
  Pending readings;
  for (const double stamp_s : {1.0, 99.5, 200.0}) readings.put(stamp_s, 1);
  EXPECT_EQ(readings.take(100.0).size(), 1u) << "before the first pair nobody knew the time";
  readings.put(100.5, 1);
  readings.put(5.0, 2);
  EXPECT_EQ(readings.take(5.0), std::vector<int>{2}) << "the clock was set back";
  EXPECT_EQ(readings.refused(), 0u);
}

TEST(PendingReadings, WithoutAPairTheMemoryIsBounded) {
  Pending readings;
  for (int i = 0; i < 100000; ++i) readings.put(1e-3 * i, i);
  const std::vector<int> taken = readings.take(100.0);
  ASSERT_FALSE(taken.empty());
  EXPECT_EQ(taken.back(), 99999);
  EXPECT_GT(readings.refused(), 80000u) << "what gave way is counted";
}

}  // namespace
}  // namespace flight_corridor
