#pragma once

#include <cstdint>
#include <random>

namespace flight_corridor::sim {

/// The purpose of a stream of random numbers: streams of one seed are independent, so that drawing more from one leaves
/// the others as they are.
enum class Stream : std::uint64_t { Scene, LidarNoise, LidarFault, LeftImage, RightImage, ImuNoise, AttitudeNoise };

/// Seed of a stream, or of the index-th piece of it.
inline std::uint64_t streamSeed(std::uint64_t seed, Stream stream, std::uint64_t index = 0) {
  std::seed_seq sequence{seed, seed >> 32, static_cast<std::uint64_t>(stream), index};
  std::uint32_t words[2];
  sequence.generate(words, words + 2);
  return (std::uint64_t{words[0]} << 32) | words[1];
}

/// Seeded random numbers.
class Random {
 public:
  Random(std::uint64_t seed, Stream stream) : engine_(streamSeed(seed, stream)) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  double normal(double std) { return std * std::normal_distribution<double>()(engine_); }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
  double sign() { return chance(0.5) ? 1.0 : -1.0; }
  /// Size within [low, high], either sign.
  double eitherSign(double low, double high) {
    const double chosen_sign = sign();
    return chosen_sign * uniform(low, high);
  }
  std::uint32_t word() { return static_cast<std::uint32_t>(engine_()); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace flight_corridor::sim
