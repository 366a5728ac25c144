#pragma once

#include <cstdint>

namespace flight_corridor {

// The matcher's result is bit-identical on every processor: all steps up to the indices and flags are sums, minima and
// comparisons of integers, whose order does not matter; quotients are integers, too, and rounded as written. A match
// becomes a float only at the end, by one product with a power of two and one sum.

constexpr int kDisparityStep = 64;        ///< Curves over disparity are stored in multiples of it: whole vectors.
constexpr int kLargestDisparities = 256;  ///< A disparity's index is kept in 8 bits.

/// Disparities as they are stored: up to the next multiple of kDisparityStep.
constexpr int storedDisparities(int num_disparities) {
  return (num_disparities + kDisparityStep - 1) / kDisparityStep * kDisparityStep;
}

// Matching costs C(p, d): the Hamming distance of census codes (Zabih and Woodfill 1994). The code compares 13 pairs of
// pixels opposite each other in a window of 9 x 3, and the middle with the three above it: pairs do not share a noisy
// centre (centre-symmetric: Spangenberg et al. 2013), and a flat window keeps level branches. Beyond an image its last
// pixels count.
constexpr int kCensusBits = 16;                        ///< Two bytes per pixel; also the largest cost.
constexpr int kCensusReach_px = 4;                     ///< Of the window, along the row.
constexpr std::uint8_t kBrighter_grey = 1;             ///< A larger difference sets a bit: noise and rounding do not.
constexpr std::uint8_t kUnseenCost = kCensusBits / 2;  ///< Out of the right camera's view: that of chance.
constexpr std::uint8_t kNoDisparityCost = 255;         ///< Beyond the last disparity searched: never the best.

// Semi-global aggregation (Hirschmueller 2008, eq. 13 and 14) along five paths, from the left, right, above, above left
// and above right: L(p, d) = C(p, d) + min(L(q, d), L(q, d -+ 1) + P1, min_i L(q, i) + P2) - min_i L(q, i), q the pixel
// before p; L = C at a path's start; S = sum of L. With costs up to 16, L is at most 36 and S 180: 8 bits hold them.
constexpr std::uint8_t kSmallStepPenalty = 4;   ///< P1, a change of disparity by one: a quarter of the bits.
constexpr std::uint8_t kLargeStepPenalty = 20;  ///< P2, a larger one: above the worst cost: noise makes no step.
constexpr std::uint8_t kEdgeStepPenalty = 8;    ///< P2 where the grey value steps: half the bits, as chance.
constexpr std::uint8_t kEdge_grey = 10;         ///< A larger step between neighbours is not shading: 3 to 5 sigma.

/// Beyond this above its minimum, S contradicts a disparity: half a code, or a tenth of a code per path.
constexpr std::uint8_t kContradiction = 8;
constexpr int kConsistent_px = 1;  ///< Both views' whole disparities may differ by rounding.

// Competitors of a match (consistent and distinct): secondary minima of C in a window of 7 x 3, as good as the match
// and separated from it by a barrier. They are searched in the costs, since smoothing turns a tie, or no information,
// into certainty. A window's cost is the sum over its columns of half of each column's, halves upwards; the match's is
// the lowest of its disparity's and its two neighbours'. A best disparity is distinct if half of those whose whole
// window the right camera sees are clearly worse.
constexpr int kWindowReach_px = 3;          ///< Also of the sub-pixel fit's window: flat, like the census's.
constexpr std::uint8_t kAsGood = 3;         ///< 0.3 bits per pixel, of the 21, halved.
constexpr std::uint8_t kBarrier = 31;       ///< 3 bits per pixel, of the 21, halved.
constexpr std::uint8_t kClearlyWorse = 10;  ///< 1 bit per pixel, of the 21, halved: a flat surface has less.

// Sub-pixel: o = (p + q) / 2 [1 / kSubpixels px], whose errors are independent. p is the minimum of a parabola through
// S at the best disparity and beside it, which is biased towards whole pixels. q is the shift of the window that
// explains the images' difference best, whatever their exposures' offset (Lucas and Kanade 1981), regularised towards p
// if there is little gradient:
//   p = kSubpixels (S(d - 1) - S(d + 1)) / (2 (S(d - 1) + S(d + 1) - 2 S(d))),
//   q = kSubpixels (num + kNoise p / kSubpixels) / (den + kNoise),  num = 4 (21 ge - g e),  den = 21 gg - g g;
//   o = p unless |num| < den, for then the shift leads away from the match; o = 0 where S is flat or ends.
// g, e, gg, ge: sums over the window, the right image moved by d, of g = four times the grey gradient along the row,
// mean of both images, of e = right less left, and of their products. Each quotient is rounded to the nearest, halves
// away from zero.
constexpr int kSubpixels = 64;                ///< Steps of a pixel.
constexpr int kNoise = 21 * 16 * 60;          ///< 3 squared grey levels per pixel, in the units of den.
constexpr std::int16_t kNoSubpixel = -10000;  ///< Far below any result, so that it joins no average.

// Matches are averaged over 5 x 5 pixels, each weighted by kSubpixels less its difference from the middle, if that is
// positive (Tomasi and Manduchi 1998): their errors are random; surfaces before or behind are excluded. The average
// differs from the middle one by a quotient in 1 / kFineSteps of kSubpixels, rounded towards zero.
constexpr int kAverageReach_px = 2;
constexpr int kFineSteps = 16;

constexpr float kLargestOffset_px = 1.5f;              ///< Below zero, of a rig; a match beyond it is wrong.
constexpr float kSmallestDisparity_px = 1.0f / 16.0f;  ///< Assigned to matches below it: as far as can be resolved.

}  // namespace flight_corridor
