#include "sim/lidar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace flight_corridor::sim {
namespace {

constexpr int kRays = 13;
constexpr double kGoldenAngle_rad = 2.39996322972865332;
constexpr double kFarthestOutlier_m = 30.0;
constexpr double kFaultyOffset_m = 9.0;
constexpr double kSpikeShare = 0.2;
constexpr double kBurstPeriod_s = 1.0;
constexpr double kBurst_s = 0.25;
constexpr int kSlowDown = 20;

// In the order of LidarFault::Kind.
constexpr std::array<const char*, 10> kFaultNames{"none",   "offset",   "frozen", "zeros", "spikes",
                                                  "bursts", "drop_out", "silent", "slow",  "nan"};

double castRay(const std::vector<Primitive>& primitives, const Eigen::Vector3d& origin_W,
               const Eigen::Vector3d& direction_W) {
  double range_m = kInfinity;
  LidarReturn answer = LidarReturn::Surface;
  for (const Primitive& primitive : primitives) {
    if (primitive.material.lidar_return == LidarReturn::PassesThrough) continue;
    const Eigen::Isometry3d T_O_W = primitive.T_W_O.inverse();
    const auto hit =
        intersect(primitive, (T_O_W * origin_W).cast<float>(), (T_O_W.linear() * direction_W).cast<float>());
    if (!hit || hit->t >= range_m) continue;
    range_m = hit->t;
    answer = primitive.material.lidar_return;
  }
  return answer == LidarReturn::Absorbed ? kInfinity : range_m;
}

}  // namespace

std::vector<std::string> lidarFaultNames() { return {kFaultNames.begin(), kFaultNames.end()}; }

LidarFault::Kind lidarFaultFromName(const std::string& name) {
  const auto found = std::find(kFaultNames.begin(), kFaultNames.end(), name);
  if (found != kFaultNames.end()) return static_cast<LidarFault::Kind>(found - kFaultNames.begin());
  std::string known;
  for (const char* fault : kFaultNames) known += std::string(" ") + fault;
  throw std::invalid_argument("unknown LiDAR fault '" + name + "'; known are:" + known);
}

double castBeam(const std::vector<Primitive>& primitives, const Eigen::Isometry3d& T_W_L, double field_of_view_rad) {
  std::array<double, kRays> ranges_m;
  for (int i = 0; i < kRays; ++i) {
    // A sunflower fills the cone evenly.
    const double off_axis = std::tan(field_of_view_rad / 2.0) * std::sqrt((i + 0.5) / kRays);
    const Eigen::Vector3d direction_L(1.0, off_axis * std::cos(i * kGoldenAngle_rad),
                                      off_axis * std::sin(i * kGoldenAngle_rad));
    ranges_m[i] = castRay(primitives, T_W_L.translation(), T_W_L.linear() * direction_L.normalized());
  }
  std::nth_element(ranges_m.begin(), ranges_m.begin() + kRays / 3, ranges_m.end());
  return ranges_m[kRays / 3];
}

Lidar::Lidar(const LidarModel& model, const LidarFault& fault, std::uint64_t seed)
    : model_(model), fault_(fault), noise_(seed, Stream::LidarNoise), fault_noise_(seed, Stream::LidarFault) {}

std::optional<RangeReading> Lidar::read(double true_range_m, double time_s) {
  double range_m = measure(true_range_m);
  ++count_;
  if (fault_.from_s <= time_s && time_s < fault_.until_s) {
    if (fault_.kind == LidarFault::Kind::Silent) return std::nullopt;
    if (fault_.kind == LidarFault::Kind::Slow && count_ % kSlowDown != 0) return std::nullopt;
    range_m = corrupt(range_m, time_s);
  }
  last_range_m_ = range_m;
  return RangeReading{time_s, range_m, model_.min_range_m, model_.max_range_m, model_.field_of_view_rad};
}

double Lidar::measure(double true_range_m) {
  const double noise_m = noise_.normal(model_.noise_m);
  const double outlier_m = noise_.uniform(model_.min_range_m, kFarthestOutlier_m);
  const double chance = noise_.uniform(0.0, 1.0);
  if (chance < model_.drop_out_share) return kInfinity;
  if (chance < model_.drop_out_share + model_.outlier_share) return outlier_m;
  return withinLimits(true_range_m + noise_m);
}

double Lidar::withinLimits(double range_m) const {
  if (range_m < model_.min_range_m) return -kInfinity;
  return range_m > model_.max_range_m ? kInfinity : range_m;
}

double Lidar::corrupt(double range_m, double time_s) {
  const bool in_burst = std::fmod(time_s - fault_.from_s, kBurstPeriod_s) < kBurst_s;
  const double spike_m = fault_noise_.uniform(model_.min_range_m, kFarthestOutlier_m);
  switch (fault_.kind) {
    case LidarFault::Kind::Offset:
      return withinLimits(range_m + kFaultyOffset_m);
    case LidarFault::Kind::Frozen:
      return count_ > 1 ? last_range_m_ : range_m;
    case LidarFault::Kind::Zeros:
      return 0.0;
    case LidarFault::Kind::Spikes:
      return fault_noise_.chance(kSpikeShare) ? spike_m : range_m;
    case LidarFault::Kind::Bursts:
      return in_burst ? spike_m : range_m;
    case LidarFault::Kind::DropOut:
      return kInfinity;
    case LidarFault::Kind::NotANumber:
      return kNaN;
    case LidarFault::Kind::None:
    case LidarFault::Kind::Silent:
    case LidarFault::Kind::Slow:
      break;
  }
  return range_m;
}

}  // namespace flight_corridor::sim
