// Cost of the range fusion for one frame: what arrives between two stereo pairs at 30 Hz.
#include <benchmark/benchmark.h>

#include "flight_corridor/range/range_fusion.hpp"

namespace {

using namespace flight_corridor;

constexpr double kFrame_s = 1.0 / 30.0;
constexpr double kLate_s = 0.15;  // of the stereo range, by its computing time

/// @param state.range(0), state.range(1)  rates of the LiDAR and the IMU [Hz]; 0: none.
void BM_OneFrame(benchmark::State& state) {
  const double rates_hz[] = {static_cast<double>(state.range(0)), static_cast<double>(state.range(1))};
  RangeFusion fusion((FusionConfig()));
  double now_s = 0.0, next_s[] = {0.0, 0.0};
  for (auto _ : state) {
    now_s += kFrame_s;
    for (; rates_hz[0] > 0.0 && next_s[0] <= now_s; next_s[0] += 1.0 / rates_hz[0])
      fusion.add(Sensor::Lidar, next_s[0], 5.0, 6e-4);
    for (; rates_hz[1] > 0.0 && next_s[1] <= now_s; next_s[1] += 1.0 / rates_hz[1])
      fusion.addAcceleration(next_s[1], 0.1);
    fusion.add(Sensor::Stereo, now_s - kLate_s, 5.0, 4e-3);
    benchmark::DoNotOptimize(fusion.at(now_s));
  }
}
BENCHMARK(BM_OneFrame)->ArgNames({"lidar_hz", "imu_hz"})->Args({100, 0})->Args({100, 200})->Args({500, 1000});

}  // namespace

BENCHMARK_MAIN();
