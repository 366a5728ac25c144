#pragma once

#include <cstdint>

namespace flight_corridor {

// What the matcher finds is the same, bit by bit, on every processor: all steps up to the indices and flags are sums,
// minima and comparisons of whole numbers, which no order changes; quotients are whole, too, and rounded as written. A
// match becomes a float in the end only, by one product with a power of two and one sum.

constexpr int kDisparityStep = 64;        ///< Curves over disparity are stored in multiples of it: whole vectors.
constexpr int kLargestDisparities = 256;  ///< A disparity's index is kept in 8 bits.

/// Disparities as they are stored: up to the next multiple of kDisparityStep.
constexpr int storedDisparities(int num_disparities) {
  return (num_disparities + kDisparityStep - 1) / kDisparityStep * kDisparityStep;
}

// Matching costs C(p, d): the Hamming distance of census codes (Zabih and Woodfill 1994). The code compares 13 pairs of
// pixels that lie opposite each other in a window of 9 x 3, and the middle with the three above it: pairs do not share
// a noisy centre (centre-symmetric: Spangenberg et al. 2013), and a flat window keeps level branches. Beyond an image
// its last pixels count.
constexpr int kCensusBits = 16;                        ///< Two bytes a pixel; also the largest cost.
constexpr int kCensusReach_px = 4;                     ///< Of the window, along the row.
constexpr std::uint8_t kBrighter_grey = 1;             ///< More makes a bit: noise and rounding make none.
constexpr std::uint8_t kUnseenCost = kCensusBits / 2;  ///< Where the right camera does not look: that of chance.
constexpr std::uint8_t kNoDisparityCost = 255;         ///< Behind the last disparity searched: never the best.

// Semi-global aggregation (Hirschmueller 2008, eq. 13 and 14) along five paths, from the left, right, above, above left
// and above right: L(p, d) = C(p, d) + min(L(q, d), L(q, d -+ 1) + P1, min_i L(q, i) + P2) - min_i L(q, i), q the pixel
// before p; L = C where a path begins; S = sum of L. With costs up to 16, L is at most 36 and S 180: 8 bits hold them.
constexpr std::uint8_t kSmallStepPenalty = 4;   ///< P1, a change of disparity by one: a quarter of the bits.
constexpr std::uint8_t kLargeStepPenalty = 20;  ///< P2, a larger one: above the worst cost, so that noise makes none.
constexpr std::uint8_t kEdgeStepPenalty = 8;    ///< P2 where the grey value steps: half the bits, what chance costs.
constexpr std::uint8_t kEdge_grey = 10;         ///< A larger step between neighbours is no shading: some 3 to 5 sigma.

/// How far above its minimum S contradicts a disparity: half a code, or a tenth of a code a path.
constexpr std::uint8_t kContradiction = 8;
constexpr int kConsistent_px = 1;  ///< Both views' whole disparities may differ by rounding.

// Competitors of a match (consistent and distinct): secondary minima of C in a window of 7 x 3, as good as the match
// and separated from it by a barrier. They are looked for in the costs, since smoothing makes certainty of a tie, or of
// nothing. A window's cost is the sum over its columns of half of each column's, halves upwards; the match's is the
// lowest of its disparity's and of those of the two beside it. Distinct is a best disparity than which half of those
// are clearly worse whose whole window the right camera sees.
constexpr int kWindowReach_px = 3;          ///< Also that of the sub-pixel fit's window: flat, as the census's.
constexpr std::uint8_t kAsGood = 3;         ///< 0.3 bits a pixel, of the 21, halved.
constexpr std::uint8_t kBarrier = 31;       ///< 3 bits a pixel, of the 21, halved.
constexpr std::uint8_t kClearlyWorse = 10;  ///< 1 bit a pixel, of the 21, halved: a flat surface has less.

// Sub-pixel: o = (p + q) / 2 [1 / kSubpixels px], two that err independently. p is the minimum of a parabola through S
// at the best disparity and beside it, which is biased towards whole pixels. q is the shift of the window that explains
// the images' difference best, whatever their exposures' offset (Lucas and Kanade 1981), drawn to p where there is
// little gradient:
//   p = kSubpixels (S(d - 1) - S(d + 1)) / (2 (S(d - 1) + S(d + 1) - 2 S(d))),
//   q = kSubpixels (num + kNoise p / kSubpixels) / (den + kNoise),  num = 4 (21 ge - g e),  den = 21 gg - g g;
//   o = p unless |num| < den, for then the shift leads away from the match; o = 0 where S is flat or ends.
// g, e, gg, ge: sums over the window, the right image moved by d, of g = four times the grey gradient along the row,
// mean of both images, of e = right less left, and of their products. Each quotient is rounded to the nearest, halves
// away from zero.
constexpr int kSubpixels = 64;                ///< Steps of a pixel.
constexpr int kNoise = 21 * 16 * 60;          ///< 3 squared grey levels a pixel, in the units of den.
constexpr std::int16_t kNoSubpixel = -10000;  ///< Far below all that is found, so that it joins no average.

// Matches are averaged over 5 x 5 pixels, each weighted by kSubpixels less what it differs from the middle, if that is
// positive (Tomasi and Manduchi 1998): they err by chance; what lies before or behind stays out. The average differs
// from the middle one by a quotient in 1 / kFineSteps of kSubpixels, rounded towards zero.
constexpr int kAverageReach_px = 2;
constexpr int kFineSteps = 16;

constexpr float kLargestOffset_px = 1.5f;              ///< Below zero, of a rig; a match still farther is a wrong one.
constexpr float kSmallestDisparity_px = 1.0f / 16.0f;  ///< Given to matches below it: as far as can be resolved.

}  // namespace flight_corridor
