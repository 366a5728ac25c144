#include "sim/texture.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor::sim {
namespace {

constexpr int kLanes = 4;  // octaves that are computed together
using Floats = float __attribute__((vector_size(4 * kLanes)));
using Ints = std::int32_t __attribute__((vector_size(4 * kLanes)));
using Bits = std::uint32_t __attribute__((vector_size(4 * kLanes)));

Floats smooth(Floats x) { return x * x * (3.0f - 2.0f * x); }
Floats lerp(Floats a, Floats b, Floats x) { return a + x * (b - a); }

Ints floorToInt(Floats x) {
  const Ints truncated = __builtin_convertvector(x, Ints);
  return truncated + (x < __builtin_convertvector(truncated, Floats));  // true is -1
}

/// Value noise: random values in [-1, 1) on the integer lattice, smoothly interpolated. Those are an integer hash whose
/// high bits are well mixed.
Floats valueNoise(Floats x, Floats y, Floats z, Bits seed) {
  const Ints left = floorToInt(x), low = floorToInt(y), near = floorToInt(z);
  const Floats fx = smooth(x - __builtin_convertvector(left, Floats));
  const Floats fy = smooth(y - __builtin_convertvector(low, Floats));
  const Floats fz = smooth(z - __builtin_convertvector(near, Floats));
  constexpr std::uint32_t kX = 0x8da6b343u, kY = 0xd8163841u, kZ = 0xcb1ab31fu;
  const auto bits = [](Ints cells) { return __builtin_convertvector(cells, Bits); };
  const Bits corner = bits(left) * kX + bits(low) * kY + bits(near) * kZ + seed;
  const auto latticeValue = [](Bits h) -> Floats {
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    return __builtin_convertvector(__builtin_convertvector(h ^ (h << 13), Ints), Floats) * (1.0f / 2147483648.0f);
  };
  const auto row = [&](std::uint32_t off) {
    return lerp(latticeValue(corner + off), latticeValue(corner + (off + kX)), fx);
  };
  return lerp(lerp(row(0), row(kY), fy), lerp(row(kZ), row(kY + kZ), fy), fz);
}

/// Share of a wave that survives averaging over a footprint: none below two footprints (Nyquist), all from four.
float survivingShare(float wavelength_m, float footprint_m) {
  return std::clamp(wavelength_m / (2.0f * footprint_m) - 1.0f, 0.0f, 1.0f);
}

/// Octaves of equal amplitude: a 1/f spectrum, as natural images have.
float octaves(const Material& material, const Eigen::Vector3f& p_O, float footprint_m) {
  const Eigen::Vector3f p(p_O.x(), p_O.y(), p_O.z() / material.stretch);
  float sum = 0.0f, wavelength_m = material.coarsest_m;
  std::uint32_t seed = material.seed;
  for (;;) {
    Floats wavelengths_m{};
    Bits seeds{};
    for (int lane = 0; lane < kLanes; ++lane, wavelength_m *= 0.5f, seed += 0x9e3779b9u) {
      wavelengths_m[lane] = wavelength_m;
      seeds[lane] = seed;
    }
    // Off the object's origin: flat faces through it must not lie on lattice planes of all octaves at once.
    const auto at = [&](float along_m) { return along_m / wavelengths_m + 0.37f; };
    const Floats noise = valueNoise(at(p.x()), at(p.y()), at(p.z()), seeds);
    for (int lane = 0; lane < kLanes; ++lane) {
      const float share = survivingShare(wavelengths_m[lane], footprint_m);
      if (wavelengths_m[lane] < material.finest_m || share == 0.0f) return sum;
      sum += share * noise[lane];
    }
  }
}

/// Square wave from -1 to 1 whose steps take one footprint.
float squareWave(float x_m, float period_m, float footprint_m) {
  const float phase = x_m / period_m - std::floor(x_m / period_m);
  const float to_step_m = (std::abs(phase - 0.5f) - 0.25f) * period_m;
  return std::clamp(2.0f * to_step_m / footprint_m, -1.0f, 1.0f);
}

float checker(const Material& material, const Eigen::Vector3f& p_O, float footprint_m) {
  float product = survivingShare(material.checker_period_m, footprint_m);
  for (int axis = 0; axis < 3; ++axis) product *= squareWave(p_O[axis], material.checker_period_m, footprint_m);
  return product;
}

}  // namespace

float reflectance(const Material& material, const Eigen::Vector3f& p_O, float footprint_m) {
  float relative = 1.0f;
  if (material.contrast > 0.0f) relative += material.contrast * octaves(material, p_O, footprint_m);
  if (material.checker_period_m > 0.0f) relative += 0.5f * checker(material, p_O, footprint_m);
  return material.grey * std::max(relative, 0.1f);
}

float cloudySky(const Eigen::Vector3f& direction_W) {
  constexpr float kLowest = 0.15f;  // nearer to the horizon the layer of clouds would be endless
  const Eigen::Vector3f p = direction_W / (std::max(direction_W.z(), 0.0f) + kLowest * direction_W.norm());
  const Floats scales{1.0f, 2.0f, 4.0f, 8.0f};
  const Floats noise = valueNoise(scales * p.x(), scales * p.y(), Floats{} + 0.5f, Bits{7, 8, 9, 10});
  float cloud = 0.0f;
  for (int octave = 0; octave < kLanes; ++octave) cloud += noise[octave] / scales[octave];
  return 0.72f + 0.2f * std::clamp(cloud, 0.0f, 1.0f);
}

}  // namespace flight_corridor::sim
