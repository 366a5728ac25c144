#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "flight_corridor/stereo/aligned_bytes.hpp"
#include "flight_corridor/stereo/census.hpp"

namespace flight_corridor {

constexpr int kSubpixels = 64;                ///< Steps of a pixel: whole numbers come out the same everywhere.
constexpr std::int16_t kNoSubpixel = -10000;  ///< Far below all that is found, so that it joins no average.

/// Sums over a window of left and right image, the right one moved by the whole disparity: g is four times the grey
/// gradient along the row, mean of both images; e is right less left.
struct WindowMoments {
  std::int32_t g = 0, e = 0, gg = 0, ge = 0;
};

/// Where between whole disparities a match lies. Mean of two that err independently: a parabola through the sums over
/// paths, which is biased towards whole pixels, and the window's shift that explains the difference of the images best
/// (Lucas and Kanade 1981), whatever the two exposures' offset. The latter counts less where there is little gradient,
/// and not where it leads away from the match.
/// @param below, least, above sums at the disparity and one to each side, least the smallest.
/// @return [1 / kSubpixels px], at most a pixel from 0.
int subpixelOffset(int below, int least, int above, const WindowMoments& window);

/// Sub-pixel disparities of a row. One object, one thread; no memory is allocated after construction.
class SubpixelFit {
 public:
  static constexpr int kReach_px = 3;  ///< The window is 7 x 3: flat, as the census's.

  SubpixelFit(int width_px, int min_disparity_px, int num_disparities);

  /// @param sums, winner, flags of row v, as of PathAggregation and CostMinima: kConsistent where the winner leads to a
  /// pixel of the right image only.
  /// @param fixed refilled: index of the disparity [1 / kSubpixels px]; kNoSubpixel unless kConsistent.
  void fit(const GreyImage& left, const GreyImage& right, int v, const std::uint8_t* sums, const std::uint8_t* winner,
           const std::uint8_t* flags, std::int16_t* fixed);

 private:
  void prepare(const GreyImage& image, int v, int side);

  int width_px_, min_disparity_px_, num_disparities_, stored_;
  std::array<std::array<std::vector<std::int16_t>, 3>, 2> grey_, gradient_;  // of left and right: the three rows
  AlignedBytes row_;  // of an image, with its first and last pixels repeated
  std::vector<WindowMoments> moments_;
};

/// Sub-pixel disparities of an image, and their averages over 5 x 5 pixels of one surface: of those less than a pixel
/// from the middle one, the more alike the heavier (Tomasi and Manduchi 1998). Matches err by chance; what lies before
/// or behind stays out. Rows may be written, and later be averaged, side by side.
class SubpixelPlane {
 public:
  SubpixelPlane(int width_px, int height_px);

  /// Of SubpixelFit, to be written: kNoSubpixel or what lies within the disparities searched.
  std::int16_t* row(int v) { return fixed_.data() + at(v); }

  /// @param best refilled: average index of the disparity [px]; NaN where row v has none.
  void average(int v, float* best) const;

 private:
  std::size_t at(int v) const;

  int width_px_;
  std::size_t stride_;
  std::vector<std::int16_t> fixed_;  // kNoSubpixel around the image
};

}  // namespace flight_corridor
