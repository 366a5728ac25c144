#include <gtest/gtest.h>

#include <atomic>
#include <new>
#include <vector>

#include "flight_corridor/band_workers.hpp"

namespace flight_corridor {
namespace {

TEST(BandWorkers, DoEachPartOnce) {
  for (const int threads : {1, 2, 5}) {
    BandWorkers workers(threads);
    EXPECT_EQ(workers.threads(), threads);
    for (const int parts : {0, 1, 3, 40}) {
      for (int repeat = 0; repeat < 50; ++repeat) {
        std::vector<std::atomic<int>> done(parts);
        workers.run(parts, [&](int part, int) { ++done[part]; });
        for (const std::atomic<int>& times : done) EXPECT_EQ(times, 1);
      }
    }
  }
}

TEST(BandWorkers, NeverUseOneThreadTwiceAtATime) {
  BandWorkers workers(3);
  std::vector<std::atomic<int>> busy(3);
  std::atomic<int> collisions{0};
  workers.run(200, [&](int, int thread) {
    if (busy[thread].fetch_add(1) != 0) ++collisions;
    busy[thread].fetch_sub(1);
  });
  EXPECT_EQ(collisions, 0);
}

TEST(BandWorkers, WhatAPartThrowsIsThrownWhenTheOthersAreDone) {
  for (const int threads : {1, 3}) {
    BandWorkers workers(threads);
    std::atomic<int> done{0};
    const auto run = [&](int faulty) {
      workers.run(20, [&](int part, int) {
        if (part == faulty) throw std::bad_alloc();
        ++done;
      });
    };
    for (const int faulty : {0, 7, 19}) EXPECT_THROW(run(faulty), std::bad_alloc) << faulty;
    EXPECT_EQ(done, 3 * 19);
    EXPECT_NO_THROW(run(-1)) << "it works on";
    EXPECT_EQ(done, 3 * 19 + 20);
  }
}

}  // namespace
}  // namespace flight_corridor
