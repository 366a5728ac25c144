#include "sim/projector.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor::sim {
namespace {

constexpr int kTilesAcross = 5, kTilesDown = 3;
constexpr float kHalfAcross = 0.93f, kHalfDown = 0.54f;  // slopes: 86 x 57 degrees
constexpr float kTileAcross = 2.0f * kHalfAcross / kTilesAcross, kTileDown = 2.0f * kHalfDown / kTilesDown;
constexpr int kCellsAcross = 22, kCellsDown = 22;  // of a tile, a dot in most: 5 x 3 x 22 x 22 x 0.7 are 5082
constexpr float kFilled = 0.7f;
constexpr float kUnseen = 1e-3f;   // a quarter of a grey level
constexpr float kSigma = 0.0025f;  // of a dot, as a slope: 1 px at f = 400 px

/// Random value in [0, 1) of a cell of the layout.
float randomOf(int column, int row, std::uint32_t what, std::uint32_t seed) {
  std::uint32_t h = static_cast<std::uint32_t>(column) * 0x8da6b343u + static_cast<std::uint32_t>(row) * 0xd8163841u +
                    what * 0xcb1ab31fu + seed;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  return static_cast<float>(h >> 8) * (1.0f / 16777216.0f);
}

int wrapped(int cell, int cells) { return (cell % cells + cells) % cells; }

}  // namespace

float dotPattern(float across, float down, float footprint, std::uint32_t seed) {
  if (!(std::abs(across) < kHalfAcross && std::abs(down) < kHalfDown)) return 0.0f;
  const float cell_across = kTileAcross / kCellsAcross, cell_down = kTileDown / kCellsDown;
  const float u = (across + kHalfAcross) / cell_across, v = (down + kHalfDown) / cell_down;
  const float variance = kSigma * kSigma + footprint * footprint / 12.0f;  // of the dot over the pixel
  float light = 0.0f;
  for (int row = static_cast<int>(v) - 1; row <= static_cast<int>(v) + 1; ++row) {
    for (int column = static_cast<int>(u) - 1; column <= static_cast<int>(u) + 1; ++column) {
      const int x = wrapped(column, kCellsAcross), y = wrapped(row, kCellsDown);
      if (randomOf(x, y, 0, seed) >= kFilled) continue;
      const float away_across = (u - static_cast<float>(column) - randomOf(x, y, 1, seed)) * cell_across;
      const float away_down = (v - static_cast<float>(row) - randomOf(x, y, 2, seed)) * cell_down;
      light += std::exp(-0.5f * (away_across * away_across + away_down * away_down) / variance);
    }
  }
  return light * kSigma * kSigma / variance;
}

float ProjectedDots::light(const Eigen::Vector3f& point_W, const Eigen::Vector3f& normal_W, float footprint) const {
  const Eigen::Vector3f point_P = T_P_W.cast<float>() * point_W;
  if (!(point_P.z() > 0.0f)) return 0.0f;
  const float distance_m = point_P.norm();
  const float facing = -(T_P_W.linear().cast<float>() * normal_W).dot(point_P) / distance_m;
  if (!(facing > 0.0f)) return 0.0f;
  const float pattern = dotPattern(point_P.x() / point_P.z(), point_P.y() / point_P.z(), footprint, projector.seed);
  const float light = static_cast<float>(projector.strength) * pattern * facing / (distance_m * distance_m);
  return light < kUnseen ? 0.0f : light;
}

}  // namespace flight_corridor::sim
