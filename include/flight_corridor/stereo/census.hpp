#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "flight_corridor/stereo/aligned_bytes.hpp"

namespace flight_corridor {

/// Grey image of 8 bits as plain memory; a view.
struct GreyImage {
  const std::uint8_t* pixels = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  ///< Bytes from row to row.

  const std::uint8_t* row(int v) const { return pixels + v * stride; }
};

constexpr int kDisparityStep = 64;        ///< Curves over disparity are stored in multiples of it: whole vectors.
constexpr int kLargestDisparities = 256;  ///< A disparity's index is kept in 8 bits.
constexpr int kCensusBits = 16;           ///< Two bytes a pixel; also the largest cost.
constexpr std::uint8_t kUnseenCost = kCensusBits / 2;  ///< Where the right camera does not look: that of chance.
constexpr std::uint8_t kNoDisparityCost = 255;         ///< Behind the last disparity searched: never the best.

/// Disparities as they are stored: up to the next multiple of kDisparityStep.
constexpr int storedDisparities(int num_disparities) {
  return (num_disparities + kDisparityStep - 1) / kDisparityStep * kDisparityStep;
}

/// Matching costs, a row at a time: the Hamming distance of census codes (Zabih and Woodfill 1994). The code compares
/// 13 pairs of pixels that lie opposite each other in a window of 9 x 3, and the middle with the three above it: pairs
/// do not share a noisy centre (centre-symmetric: Spangenberg et al. 2013), and a flat window keeps level branches. One
/// object, one thread; no memory is allocated after construction.
class CensusCosts {
 public:
  /// @param min_disparity_px may be negative.  @param num_disparities up to kLargestDisparities.
  CensusCosts(int width_px, int min_disparity_px, int num_disparities);

  /// @param left, right of the constructor's width.  @param v row; rows beyond an image equal its last ones.
  /// @param costs refilled, aligned for vectors: width x storedDisparities(num_disparities); disparity u_l - u_r, from
  /// the smallest on, is the fast index.
  void compute(const GreyImage& left, const GreyImage& right, int v, std::uint8_t* costs);

 private:
  void pad(const GreyImage& image, int v);

  int width_px_, min_disparity_px_, num_disparities_, stored_;
  std::array<AlignedBytes, 3> rows_;  // of an image around v, with its first and last pixels repeated
  std::array<AlignedBytes, 2> left_codes_, right_codes_;
  std::array<AlignedBytes, 2>
      mirrored_;         // the right codes from the last pixel to the first, so that a curve is in order
  AlignedBytes unseen_;  // 255 where mirrored_ has no pixel
};

}  // namespace flight_corridor
