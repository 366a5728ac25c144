#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "flight_corridor/range/range_fusion.hpp"
#include "support/range_trace.hpp"

namespace flight_corridor {
namespace {

using namespace test_support;

/// Eqs. 3-9 of Trejo et al. 2019 as they stand: all readings of one moment enter at once, each a row of C.
struct PaperFilter {
  Eigen::Vector2d x;
  Eigen::Matrix2d P;

  void step(double dt, double u, const std::vector<double>& ranges_m, const std::vector<double>& variances_m2) {
    Eigen::Matrix2d A;
    A << 1, dt, 0, 1;
    x = A * x + Eigen::Vector2d(dt * dt / 2, dt) * u;
    P = A * P * A.transpose();  // the paper's process noise is zero
    const auto rows = static_cast<Eigen::Index>(ranges_m.size());
    const Eigen::VectorXd z = Eigen::VectorXd::Map(ranges_m.data(), rows);
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(rows, 2);
    C.col(0).setOnes();
    const Eigen::MatrixXd R = Eigen::VectorXd::Map(variances_m2.data(), rows).asDiagonal();
    const Eigen::MatrixXd K = P * C.transpose() * (C * P * C.transpose() + R).inverse();
    x += K * (z - C * x);
    P = (Eigen::Matrix2d::Identity() - K * C) * P;
  }
};

TEST(RangeFusionLaws, AnInfiniteGateTakesEveryReading) {
  FusionConfig config;
  config.gate_sigma = kInfinity;
  RangeFusion fusion(config);
  fusion.add(Sensor::Lidar, 0.0, 5.0, config.lidar_variance_m2);
  EXPECT_EQ(fusion.add(Sensor::Lidar, 0.01, 5.15, config.lidar_variance_m2), Outcome::Accepted) << "a leap to 15 m/s";
  EXPECT_EQ(fusion.add(Sensor::Lidar, 0.02, 50.0, config.lidar_variance_m2), Outcome::Accepted);
}

TEST(RangeFusionLaws, PaperPresetEqualsAnIndependentOracleOfItsEquations) {
  const FusionConfig config = paperSettings();
  RangeFusion fusion(config);
  std::mt19937 random(11);
  std::normal_distribution<double> noise;
  PaperFilter oracle;
  double u_mps2 = 0.0;
  for (int i = 0; i <= 400; ++i) {
    const double stamp_s = 0.01 * i, true_m = (i < 200 ? 12.0 : 8.0) - 1.5 * stamp_s;  // the jump: no gate
    const double lidar_m = true_m + std::sqrt(config.lidar_variance_m2) * noise(random);
    const double stereo_m = true_m + std::sqrt(config.stereo_variance_m2) * noise(random);
    const bool both = i % 3 == 1;
    fusion.add(Sensor::Lidar, stamp_s, lidar_m, config.lidar_variance_m2);
    if (both) fusion.add(Sensor::Stereo, stamp_s, stereo_m, config.stereo_variance_m2);
    if (i == 0) {  // the first reading is the initial state: of the rate it says nothing, 5 m/s is its prior
      oracle = {{lidar_m, 0.0}, Eigen::Vector2d(config.lidar_variance_m2, 5.0 * 5.0).asDiagonal()};
    } else if (both) {
      oracle.step(0.01, u_mps2, {lidar_m, stereo_m}, {config.lidar_variance_m2, config.stereo_variance_m2});
    } else {
      oracle.step(0.01, u_mps2, {lidar_m}, {config.lidar_variance_m2});
    }
    u_mps2 = 2.0 * std::sin(0.05 * i);  // until the next reading
    fusion.addAcceleration(stamp_s, -u_mps2);
    if (i == 0) continue;  // a lone reading is no range yet
    const RangeEstimate estimate = fusion.at(stamp_s);
    ASSERT_NEAR(estimate.range_m, oracle.x[0], 1e-9) << "reading " << i;
    ASSERT_NEAR(estimate.rate_mps, oracle.x[1], 1e-9) << "reading " << i;
    ASSERT_NEAR(estimate.sigma_m, std::sqrt(oracle.P(0, 0)), 1e-9) << "reading " << i;
  }
}

/// What the filter said of readings to come, and whether the truth was where it said.
struct Consistency {
  std::vector<std::vector<double>> runs;  // normalised innovations
  int within_two_sigma = 0, estimates = 0;
};

/// A surface whose range has exactly the process noise that the filter allows for.
class DrivenByNoise {
 public:
  DrivenByNoise(double acceleration_sigma_mps2, unsigned seed) : sigma_(acceleration_sigma_mps2), random_(seed) {
    rate_mps_ = 5.0 * noise();  // as unknown as the filter takes it to be
  }

  /// The exact discretisation: Cholesky factor of [dt^3/3 dt^2/2; dt^2/2 dt].
  void advance(double dt) {
    const double a = noise(), b = noise();
    range_m_ += rate_mps_ * dt + sigma_ * std::sqrt(dt * dt * dt / 3.0) * a;
    rate_mps_ += sigma_ * std::sqrt(dt) * (std::sqrt(3.0) / 2.0 * a + 0.5 * b);
  }
  double range() const { return range_m_; }
  double measured(double variance_m2) { return range_m_ + std::sqrt(variance_m2) * noise(); }

 private:
  double noise() { return normal_(random_); }

  double sigma_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  double range_m_ = 100.0;  // so far that no run comes to zero
  double rate_mps_ = 0.0;
};

/// 2 s of LiDAR at 100 Hz and stereo at 30 Hz.
void run(unsigned seed, Consistency& result) {
  constexpr double kStereoVariance_m2 = 0.1 * 0.1;
  const FusionConfig config;
  RangeFusion fusion(config);
  DrivenByNoise surface(config.acceleration_sigma_mps2, seed);
  std::vector<double> innovations;
  for (int i = 0; i < 600; ++i) {  // 300 Hz hold both rates
    const double stamp_s = i / 300.0;
    for (const Sensor sensor : {Sensor::Lidar, Sensor::Stereo}) {
      if (i % (sensor == Sensor::Lidar ? 3 : 10) != 0) continue;
      const double variance_m2 = sensor == Sensor::Lidar ? config.lidar_variance_m2 : kStereoVariance_m2;
      const double measured_m = surface.measured(variance_m2);
      const RangeEstimate before = fusion.at(stamp_s);
      fusion.add(sensor, stamp_s, measured_m, variance_m2);
      if (std::isnan(before.range_m)) continue;  // not confirmed yet
      innovations.push_back((measured_m - before.range_m) / std::hypot(before.sigma_m, std::sqrt(variance_m2)));
      const RangeEstimate after = fusion.at(stamp_s);
      result.within_two_sigma += std::abs(after.range_m - surface.range()) <= 2.0 * after.sigma_m;
      ++result.estimates;
    }
    surface.advance(1.0 / 300.0);
  }
  result.runs.push_back(innovations);
}

/// Mean of the products of innovations that lie lag apart, over all runs.
double correlation(const Consistency& result, std::size_t lag) {
  double sum = 0.0;
  std::size_t products = 0;
  for (const std::vector<double>& run : result.runs) {
    for (std::size_t i = lag; i < run.size(); ++i, ++products) sum += run[i] * run[i - lag];
  }
  return sum / static_cast<double>(products);
}

TEST(RangeFusionLaws, NormalisedInnovationsAreWhiteWithMeanSquareOne) {
  Consistency result;
  for (unsigned seed = 0; seed < 100; ++seed) run(seed, result);
  // N independent standard normals: their mean square has the standard deviation sqrt(2 / N), the mean of their
  // products 1 / sqrt(N). Three of them.
  const double sigma = 1.0 / std::sqrt(result.estimates);
  EXPECT_NEAR(correlation(result, 0), 1.0, 3.0 * std::sqrt(2.0) * sigma);
  for (std::size_t lag = 1; lag <= 5; ++lag) EXPECT_NEAR(correlation(result, lag), 0.0, 3.0 * sigma) << "lag " << lag;
  // 95.4 % of a normal distribution. Errors stay alike for some 0.05 s, so 100 runs of 2 s hold some 4000 independent
  // ones: 0.3 % standard deviation of their share.
  EXPECT_NEAR(result.within_two_sigma / static_cast<double>(result.estimates), 0.954, 0.01);
}

/// When both sensors have shown what came onto the beam.
double shownByBoth(double changed_s) {
  return std::max(std::ceil(changed_s * kReadings_hz) / kReadings_hz, std::ceil(changed_s * kFrames_hz) / kFrames_hz);
}

/// From one frame after both sensors have shown a surface, d_K is within 6 of its sigmas: 2 are its own; the worst
/// outlier, just inside the gate, moves it by 4 K sqrt(S), which is 4 sqrt(P / R) of them, and P is about R here.
void expectNoPeakAndNoLag(const Approach& approach, std::uint64_t seed) {
  for (const Sample& sample : fly(approach, FusionConfig(), seed)) {
    const double shown_s = std::max(0.0, shownByBoth(lastChange(approach, sample.stamp_s)));
    if (!isFrame(sample) || sample.stamp_s - shown_s < 0.99 / kFrames_hz) continue;
    EXPECT_LE(std::abs(sample.fused_m - sample.true_m), 6.0 * sample.fused_sigma_m)
        << "seed " << seed << ", " << sample.stamp_s << " s, true " << sample.true_m << " m, d_K " << sample.fused_m
        << " m, stereo " << sample.stereo_m << " m";
    EXPECT_LT(sample.fused_sigma_m, 0.1) << "seed " << seed << ", " << sample.stamp_s << " s";  // 6 of them mean a lot
  }
}

TEST(RangeFusionLaws, NoPeakAndNoLag) {
  Approach both, stereo_peaks, lidar_peaks;
  stereo_peaks.stereo_peaks = true;
  lidar_peaks.lidar_fault = {sim::LidarFault::Kind::Spikes, 0.5, kInfinity};
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    both.appears_s = 1.5 + static_cast<double>(seed) / 3000.0;  // at every phase between two frames
    both.vanishes_s = both.appears_s + 1.0;
    expectNoPeakAndNoLag(both, seed);
    expectNoPeakAndNoLag(stereo_peaks, seed);
    expectNoPeakAndNoLag(lidar_peaks, seed);
  }
}

}  // namespace
}  // namespace flight_corridor
