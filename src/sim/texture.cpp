#include "sim/texture.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor::sim {
namespace {

/// Random value in [-1, 1) of a lattice point: an integer hash whose high bits are well mixed.
float latticeValue(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t seed) {
  std::uint32_t h = x * 0x8da6b343u + y * 0xd8163841u + z * 0xcb1ab31fu + seed;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  return static_cast<float>(static_cast<std::int32_t>(h ^ (h << 13))) * (1.0f / 2147483648.0f);
}

float smooth(float x) { return x * x * (3.0f - 2.0f * x); }
float lerp(float a, float b, float x) { return a + x * (b - a); }

/// floor() without the library call that a plain x86-64 build makes of it.
std::int32_t floorToInt(float x) {
  const auto truncated = static_cast<std::int32_t>(x);
  return truncated - (x < static_cast<float>(truncated));
}

/// Value noise: random values on the integer lattice, smoothly interpolated.
float valueNoise(const Eigen::Vector3f& p, std::uint32_t seed) {
  const std::int32_t floors[3] = {floorToInt(p.x()), floorToInt(p.y()), floorToInt(p.z())};
  const float fx = smooth(p.x() - static_cast<float>(floors[0]));
  const float fy = smooth(p.y() - static_cast<float>(floors[1]));
  const float fz = smooth(p.z() - static_cast<float>(floors[2]));
  const auto x = static_cast<std::uint32_t>(floors[0]);
  const auto y = static_cast<std::uint32_t>(floors[1]);
  const auto z = static_cast<std::uint32_t>(floors[2]);
  const auto row = [&](std::uint32_t dy, std::uint32_t dz) {
    return lerp(latticeValue(x, y + dy, z + dz, seed), latticeValue(x + 1, y + dy, z + dz, seed), fx);
  };
  return lerp(lerp(row(0, 0), row(1, 0), fy), lerp(row(0, 1), row(1, 1), fy), fz);
}

/// Share of a wave that survives averaging over a footprint: none below two footprints (Nyquist), all from four.
float survivingShare(float wavelength_m, float footprint_m) {
  return std::clamp(wavelength_m / (2.0f * footprint_m) - 1.0f, 0.0f, 1.0f);
}

/// Octaves of equal amplitude: a 1/f spectrum, as natural images have.
float octaves(const Material& material, const Eigen::Vector3f& p_O, float footprint_m) {
  const Eigen::Vector3f p(p_O.x(), p_O.y(), p_O.z() / material.stretch);
  float sum = 0.0f;
  std::uint32_t seed = material.seed;
  for (float wavelength_m = material.coarsest_m; wavelength_m >= material.finest_m; wavelength_m *= 0.5f) {
    const float share = survivingShare(wavelength_m, footprint_m);
    if (share == 0.0f) break;
    // Half a cell off the object's origin: flat faces through it must not lie on lattice planes of all octaves at once.
    sum += share * valueNoise((p / wavelength_m).array() + 0.37f, seed);
    seed += 0x9e3779b9u;
  }
  return sum;
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
  float cloud = 0.0f;
  for (int octave = 0; octave < 4; ++octave) {
    const auto scale = static_cast<float>(1 << octave);
    cloud += valueNoise(Eigen::Vector3f(scale * p.x(), scale * p.y(), 0.5f), 7u + octave) / scale;
  }
  return 0.72f + 0.2f * std::clamp(cloud, 0.0f, 1.0f);
}

}  // namespace flight_corridor::sim
