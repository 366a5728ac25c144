#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "sim/lidar.hpp"

namespace flight_corridor::sim {
namespace {

using Kind = LidarFault::Kind;

LidarModel faultlessModel() {
  LidarModel model;
  model.drop_out_share = 0.0;
  model.outlier_share = 0.0;
  return model;
}

/// What 100 readings of a still surface say; NaN where the driver sends nothing.
std::vector<double> readStill(const LidarModel& model, const LidarFault& fault, double true_range_m) {
  Lidar lidar(model, fault, 7);
  std::vector<double> ranges_m;
  for (int i = 0; i < 100; ++i) {
    const auto reading = lidar.read(true_range_m, 0.01 * i);
    ranges_m.push_back(reading ? reading->range_m : kNaN);
  }
  return ranges_m;
}

std::vector<double> readStill(Kind kind, double from_s = 0.0) {
  return readStill(faultlessModel(), {kind, from_s, kInfinity}, 5.0);
}

Primitive wallAt(double x_m, const Material& material = {}) { return makeBox({x_m + 0.5, 0, 0}, {1, 9, 9}, material); }

TEST(CastBeam, MeasuresAlongTheBeamNotAlongTheSurfaceNormal) {
  Eigen::Isometry3d T_W_L = Eigen::Isometry3d::Identity();
  EXPECT_NEAR(castBeam({wallAt(4.0)}, T_W_L, 0.0), 4.0, 1e-5);
  T_W_L.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));
  EXPECT_NEAR(castBeam({wallAt(4.0)}, T_W_L, 0.0), 4.0 / std::cos(0.3), 1e-5);
}

TEST(CastBeam, TakesTheNearSurfaceOnlyWhenItFillsAThirdOfTheCone) {
  // At 3 m a cone of 0.02 rad is 60 mm wide; a pole fills of it about its own width.
  const auto before = [](double radius_m) {
    return std::vector<Primitive>{makeCylinder({3, 0, -2}, {3, 0, 2}, radius_m, {}), wallAt(6.0)};
  };
  EXPECT_NEAR(castBeam(before(0.02), Eigen::Isometry3d::Identity(), 0.02), 2.98, 0.02);
  EXPECT_NEAR(castBeam(before(0.004), Eigen::Isometry3d::Identity(), 0.02), 6.0, 1e-3);
}

TEST(CastBeam, PassesThroughGlassAndGetsNothingFromAnAbsorbingSurface) {
  Material glass, dark;
  glass.lidar_return = LidarReturn::PassesThrough;
  dark.lidar_return = LidarReturn::Absorbed;
  const auto cast = [](const std::vector<Primitive>& world) {
    return castBeam(world, Eigen::Isometry3d::Identity(), 0.01);
  };
  EXPECT_NEAR(cast({wallAt(2.0, glass), wallAt(6.0)}), 6.0, 1e-3);
  EXPECT_EQ(cast({wallAt(2.0, dark), wallAt(6.0)}), kInfinity);
  EXPECT_NEAR(cast({wallAt(2.0), wallAt(6.0, dark)}), 2.0, 1e-3);
  EXPECT_EQ(cast({}), kInfinity);
}

TEST(Lidar, SaysMinusInfinityWhenTooCloseAndPlusInfinityWhenNothingIsInRange) {
  for (const double range_m : readStill(faultlessModel(), {}, 0.05)) EXPECT_EQ(range_m, -kInfinity);
  for (const double range_m : readStill(faultlessModel(), {}, 120.0)) EXPECT_EQ(range_m, kInfinity);
  for (const double range_m : readStill(faultlessModel(), {}, kInfinity)) EXPECT_EQ(range_m, kInfinity);
}

TEST(Lidar, CarriesStampLimitsAndBeamWidth) {
  const LidarModel model;
  const auto reading = Lidar(model, {}, 1).read(5.0, 0.25);
  ASSERT_TRUE(reading);
  EXPECT_EQ(reading->stamp_s, 0.25);
  EXPECT_EQ(reading->min_range_m, model.min_range_m);
  EXPECT_EQ(reading->max_range_m, model.max_range_m);
  EXPECT_EQ(reading->field_of_view_rad, model.field_of_view_rad);
}

TEST(Lidar, HasTheNoiseOutliersAndDropOutsOfItsModel) {
  LidarModel model;
  model.drop_out_share = 0.1;
  model.outlier_share = 0.1;
  Lidar lidar(model, {}, 3);
  constexpr int kCount = 10000;
  int drop_outs = 0, good = 0;
  double squares_m2 = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double error_m = lidar.read(5.0, 0.01 * i)->range_m - 5.0;
    if (error_m == kInfinity) ++drop_outs;
    if (std::abs(error_m) > 5.0 * model.noise_m) continue;
    ++good;
    squares_m2 += error_m * error_m;
  }
  // Binomial: sigma = sqrt(n p q) = 30 and 40; of a sample's standard deviation: 1/sqrt(2 n) = 0.8 %. Four sigma each;
  // 1 % of the outliers fall among the good ones.
  EXPECT_NEAR(drop_outs, 1000, 120);
  EXPECT_NEAR(good, 8000, 170);
  EXPECT_NEAR(std::sqrt(squares_m2 / good), model.noise_m, 0.04 * model.noise_m);
}

TEST(Lidar, NoiseDoesNotDependOnTheFault) {
  const std::vector<double> healthy_m = readStill(Kind::None);
  const std::vector<double> offset_m = readStill(Kind::Offset);
  const std::vector<double> spikes_m = readStill(Kind::Spikes);
  int spikes = 0;
  for (std::size_t i = 0; i < healthy_m.size(); ++i) {
    EXPECT_NEAR(offset_m[i] - healthy_m[i], 9.0, 1e-9);
    spikes += spikes_m[i] != healthy_m[i];
  }
  EXPECT_NEAR(spikes, 20, 16);  // a fifth of 100, four sigma of 4
}

TEST(Lidar, FaultsLastFromTheirBeginToTheirEnd) {
  const std::vector<double> ranges_m = readStill(faultlessModel(), {Kind::Zeros, 0.3, 0.6}, 5.0);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(ranges_m[i] == 0.0, 30 <= i && i < 60) << i;
}

TEST(Lidar, FreezesAtItsLastGoodReading) {
  const std::vector<double> ranges_m = readStill(Kind::Frozen, 0.5);
  for (int i = 50; i < 100; ++i) EXPECT_EQ(ranges_m[i], ranges_m[49]);
  EXPECT_NE(ranges_m[48], ranges_m[49]);
  EXPECT_NEAR(readStill(Kind::Frozen).front(), 5.0, 0.1);
}

TEST(Lidar, EachFaultLooksAsOnRealOnes) {
  for (const double range_m : readStill(Kind::DropOut)) EXPECT_EQ(range_m, kInfinity);
  for (const double range_m : readStill(Kind::NotANumber)) EXPECT_TRUE(std::isnan(range_m));
  const std::vector<double> bursts_m = readStill(Kind::Bursts);
  for (int i = 25; i < 100; ++i) EXPECT_NEAR(bursts_m[i], 5.0, 0.1);
  EXPECT_GT(std::abs(bursts_m[3] - 5.0), 0.1);
}

TEST(Lidar, SendsNothingWhenSilentAndLittleWhenSlow) {
  int silent = 0, slow = 0;
  Lidar silent_lidar({}, {Kind::Silent}, 1), slow_lidar({}, {Kind::Slow}, 1);
  for (int i = 0; i < 100; ++i) {
    silent += silent_lidar.read(5.0, 0.01 * i).has_value();
    slow += slow_lidar.read(5.0, 0.01 * i).has_value();
  }
  EXPECT_EQ(silent, 0);
  EXPECT_EQ(slow, 5);
}

TEST(LidarFault, IsFoundByEachOfItsNamesAndNoOther) {
  for (const std::string& name : lidarFaultNames()) EXPECT_NO_THROW(lidarFaultFromName(name));
  EXPECT_EQ(lidarFaultFromName("none"), Kind::None);
  EXPECT_EQ(lidarFaultFromName("nan"), Kind::NotANumber);
  EXPECT_THROW(lidarFaultFromName("broken"), std::invalid_argument);
}

}  // namespace
}  // namespace flight_corridor::sim
