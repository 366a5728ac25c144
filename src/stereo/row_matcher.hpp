#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <vector>

#include "flight_corridor/stereo/matching_rules.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"

namespace flight_corridor {

constexpr std::align_val_t kAlignment{64};  // a cache line; no vector is longer

struct AlignedDelete {
  void operator()(std::uint8_t* bytes) const { ::operator delete(bytes, kAlignment); }
};
using AlignedBytes = std::unique_ptr<std::uint8_t[], AlignedDelete>;

constexpr int kPad_px = 16;          // before and behind a row: windows and vectors of words reach no farther
constexpr int kVectorSlack_px = 64;  // behind all that vectors read or write

constexpr int kBlock_px = 64;  // pixels per block of paths, minima and windows: its data stays in the cache
constexpr int kColumns = 8;    // of a moving window, kept: its own and one more; a power of two

constexpr int kLargestWindow = (2 * kWindowReach_px + 1) * (3 * kCensusBits / 2);
static_assert(kLargestWindow + std::max(kBarrier, kClearlyWorse) <= 255, "8 bits");

struct ImagePair {
  GreyImage left, right;
};

/// The memory of one thread to match a band, row by row. Rings hold the rows that windows reach; a row's number, modulo
/// the ring's length, is its place.
struct RowMatcher {
  explicit RowMatcher(const MatcherSize& matcher_size);

  /// Matches rows [first_v, end_v).  @param fixed refilled: sub-pixel indices, as of SubpixelPlane.
  void matchBand(const ImagePair& images, int first_v, int end_v, const MatchPlanes& out, class SubpixelPlane& fixed);

  const std::uint8_t* leftRow(int v) const { return left[v & 3].get() + kPad_px; }
  const std::uint8_t* rightRow(int v) const { return right[v & 3].get() + kPad_px; }
  std::uint8_t* costsOf(int v) { return costs[static_cast<std::size_t>(v) % 3].get(); }

  /// Of a row until the next one has given the costs below.
  struct Found {
    AlignedBytes winner, rise_below, rise_above;  // best index; what S is more there, one disparity below and above
    AlignedBytes flags;
  };

  MatcherSize size;
  int stored, words;                                  // disparities, and words of a set, a pixel
  std::array<AlignedBytes, 4> left, right;            // rows of the images, their first and last pixels repeated
  std::array<AlignedBytes, 2> left_codes;             // of the census: low and high bytes
  std::array<AlignedBytes, 2> right_codes, mirrored;  // mirrored from the last pixel to the first: a curve is in order
  AlignedBytes unseen, beyond;  // 255 where mirrored has no pixel, and where curves have no disparity
  std::array<AlignedBytes, 3> costs;
  AlignedBytes sums;
  AlignedBytes above, above_left, above_right;  // L of the row before, less its minimum; the oblique ones lie at the
                                                // place of their first pixel, so that each is updated where it is
  AlignedBytes level;                           // P2 by pixel, of the step from the left
  std::array<AlignedBytes, 3> from_above;       // and of those from above, above left and above right
  AlignedBytes columns;                         // of the moving window: sums of three costs, halved
  AlignedBytes windows;                         // costs in the windows of a block's pixels
  AlignedBytes right_winner;                    // of the right view's pixels, the last one first
  std::array<Found, 2> found;
  std::vector<std::uint64_t> seen, whole;  // words a pixel: whose pixel, whose whole window the right camera sees
  std::vector<std::int32_t> moments;       // g, e, gg, ge a pixel
  int rows = 0;                            // of the band so far
};

/// Sub-pixel indices [1 / kSubpixels] of an image: kNoSubpixel where there is no match, and around the image. Rows may
/// be written, and later be averaged, side by side.
class SubpixelPlane {
 public:
  explicit SubpixelPlane(const MatcherSize& size);

  std::int16_t* row(int v) {
    return fixed_.data() + static_cast<std::size_t>(v + kAverageReach_px) * stride_ + kPad_px;
  }

  /// Averages a row and separates repeated matches from others.  @param out flags are read.
  void average(int v, const MatchPlanes& out);

 private:
  MatcherSize size_;
  std::size_t stride_;
  std::vector<std::int16_t> fixed_;
};

}  // namespace flight_corridor
