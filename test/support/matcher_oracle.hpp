#pragma once

#include <algorithm>
#include <array>
#include <climits>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "flight_corridor/stereo/matching_rules.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"

/// The matcher once more, slow and obvious: whole volumes, one cost at a time, no tricks.
namespace flight_corridor::oracle {

/// Costs or sums of an image: of pixel (u, v) and the disparity of index d.
struct Volume {
  Volume(const MatcherSize& image_size, int value)
      : size(image_size),
        values(static_cast<std::size_t>(size.width_px) * size.height_px * size.num_disparities, value) {}

  int& at(int u, int v, int d) { return values[index(u, v, d)]; }
  int at(int u, int v, int d) const { return values[index(u, v, d)]; }
  std::size_t index(int u, int v, int d) const {
    return (static_cast<std::size_t>(v) * size.width_px + u) * size.num_disparities + d;
  }

  MatcherSize size;
  std::vector<int> values;
};

/// Grey value; beyond the image that of its last pixel.
inline int greyAt(const GreyImage& image, int u, int v) {
  return image.row(std::clamp(v, 0, image.height - 1))[std::clamp(u, 0, image.width - 1)];
}

inline std::array<bool, kCensusBits> censusAt(const GreyImage& image, int u, int v) {
  std::array<bool, kCensusBits> bits{};
  int bit = 0;
  const auto compare = [&](int du, int dv, int du_other, int dv_other) {
    bits[bit++] = greyAt(image, u + du, v + dv) > greyAt(image, u + du_other, v + dv_other) + 1;
  };
  for (int du = -4; du <= 4; ++du) compare(du, -1, -du, 1);
  for (int du = 1; du <= 4; ++du) compare(-du, 0, du, 0);
  for (int du = -1; du <= 1; ++du) compare(du, -1, 0, 0);
  return bits;
}

inline Volume costs(const GreyImage& left, const GreyImage& right, const MatcherSize& size) {
  Volume volume(size, kUnseenCost);
  for (int v = 0; v < size.height_px; ++v) {
    for (int u = 0; u < size.width_px; ++u) {
      const auto left_bits = censusAt(left, u, v);
      for (int d = 0; d < size.num_disparities; ++d) {
        const int u_right = u - d - size.min_disparity_px;
        if (u_right < 0 || u_right >= size.width_px) continue;
        const auto right_bits = censusAt(right, u_right, v);
        int distance = 0;
        for (int bit = 0; bit < kCensusBits; ++bit) distance += left_bits[bit] != right_bits[bit];
        volume.at(u, v, d) = distance;
      }
    }
  }
  return volume;
}

/// Adds L of one path, pixel by pixel in the order of the sweep, to the sums of rows from first_v on.
/// @param begin_v where the path's rows begin.
inline void addPath(const GreyImage& left, const Volume& cost, int du, int dv, int begin_v, int first_v, int end_v,
                    Volume& sums) {
  const MatcherSize& size = cost.size;
  Volume length(size, 0);
  for (int v = begin_v; v < end_v; ++v) {
    for (int i = 0; i < size.width_px; ++i) {
      const int u = du > 0 ? i : size.width_px - 1 - i, u_before = u - du, v_before = v - dv;
      const bool begins = u_before < 0 || u_before >= size.width_px || v_before < begin_v;
      int least = INT_MAX, penalty = 0;
      if (!begins) {
        for (int d = 0; d < size.num_disparities; ++d) least = std::min(least, length.at(u_before, v_before, d));
        const int step = std::abs(greyAt(left, u, v) - greyAt(left, u_before, v_before));
        penalty = step > kEdge_grey ? kEdgeStepPenalty : kLargeStepPenalty;
      }
      for (int d = 0; d < size.num_disparities; ++d) {
        int best = 0;
        if (!begins) {
          best = std::min(length.at(u_before, v_before, d), least + penalty);
          if (d > 0) best = std::min(best, length.at(u_before, v_before, d - 1) + kSmallStepPenalty);
          if (d + 1 < size.num_disparities) {
            best = std::min(best, length.at(u_before, v_before, d + 1) + kSmallStepPenalty);
          }
          best -= least;
        }
        length.at(u, v, d) = cost.at(u, v, d) + best;
        if (v >= first_v) sums.at(u, v, d) += length.at(u, v, d);
      }
    }
  }
}

/// Sums over the five paths of one band's rows, those from above beginning at begin_v.
inline void addBand(const GreyImage& left, const Volume& cost, int begin_v, int first_v, int end_v, Volume& sums) {
  addPath(left, cost, 1, 0, first_v, first_v, end_v, sums);
  addPath(left, cost, -1, 0, first_v, first_v, end_v, sums);
  addPath(left, cost, 0, 1, begin_v, first_v, end_v, sums);
  addPath(left, cost, 1, 1, begin_v, first_v, end_v, sums);
  addPath(left, cost, -1, 1, begin_v, first_v, end_v, sums);
}

inline int bandsOf(int height_px) {
  return std::max(1, (height_px + SemiGlobalMatcher::kBand_px / 2) / SemiGlobalMatcher::kBand_px);
}

inline Volume sums(const GreyImage& left, const Volume& cost, int bands) {
  const int height = cost.size.height_px;
  Volume sum(cost.size, 0);
  for (int band = 0; band < bands; ++band) {
    const int first_v = height * band / bands;
    addBand(left, cost, std::max(0, first_v - SemiGlobalMatcher::kRunUp_px), first_v, height * (band + 1) / bands, sum);
  }
  return sum;
}

struct Minimum {
  int winner = 0, flags = 0;
  std::vector<bool> set;
};

inline int winnerAt(const Volume& sum, int u, int v) {
  int winner = 0;
  for (int d = 1; d < sum.size.num_disparities; ++d) {
    if (sum.at(u, v, d) < sum.at(u, v, winner)) winner = d;
  }
  return winner;
}

inline int rightWinnerAt(const Volume& sum, int u_right, int v) {
  int winner = 0, least = INT_MAX;
  for (int d = 0; d < sum.size.num_disparities; ++d) {
    const int u = u_right + d + sum.size.min_disparity_px;
    if (u < 0 || u >= sum.size.width_px || sum.at(u, v, d) >= least) continue;
    least = sum.at(u, v, d);
    winner = d;
  }
  return winner;
}

inline Minimum minimumAt(const Volume& sum, int u, int v) {
  Minimum minimum;
  minimum.winner = winnerAt(sum, u, v);
  const int least = sum.at(u, v, minimum.winner);
  for (int d = 0; d < sum.size.num_disparities; ++d) minimum.set.push_back(sum.at(u, v, d) <= least + kContradiction);
  const int u_right = u - minimum.winner - sum.size.min_disparity_px;
  if (u_right >= 0 && u_right < sum.size.width_px) {
    const int right_winner = rightWinnerAt(sum, u_right, v);
    if (std::abs(right_winner - minimum.winner) <= kConsistent_px) minimum.flags = kConsistent;
  }
  return minimum;
}

/// Cost in a window of 7 x 3, columns of three halved, halves upwards; beyond the image that of its last pixels.
inline int windowCost(const Volume& cost, int u, int v, int d) {
  const int last_u = cost.size.width_px - 1, last_v = cost.size.height_px - 1;
  int sum = 0;
  for (int du = -3; du <= 3; ++du) {
    int column = 0;
    for (int dv = -1; dv <= 1; ++dv) {
      column += cost.at(std::clamp(u + du, 0, last_u), std::clamp(v + dv, 0, last_v), d);
    }
    sum += (column + 1) / 2;
  }
  return sum;
}

/// Cost in a window around a pixel, of each disparity.
inline std::vector<int> windowCosts(const Volume& cost, int u, int v) {
  std::vector<int> window;
  for (int d = 0; d < cost.size.num_disparities; ++d) window.push_back(windowCost(cost, u, v, d));
  return window;
}

/// Of the winner and its two neighbours, in a window.
inline int bestAround(const std::vector<int>& window, int winner) {
  int best = window[winner];
  if (winner > 0) best = std::min(best, window[winner - 1]);
  if (winner + 1 < static_cast<int>(window.size())) best = std::min(best, window[winner + 1]);
  return best;
}

inline bool seenByRight(const MatcherSize& size, int u, int d) {
  const int u_right = u - d - size.min_disparity_px;
  return u_right >= 0 && u_right < size.width_px;
}

/// Disparities that fit as well as the winner, seen by the right camera, with a barrier between.
inline std::vector<int> competitorsAt(const Volume& cost, int u, int v, int winner) {
  const std::vector<int> window = windowCosts(cost, u, v);
  const int best = bestAround(window, winner);
  std::vector<int> competitors;
  for (int d = 0; d < cost.size.num_disparities; ++d) {
    if (!seenByRight(cost.size, u, d) || window[d] > best + kAsGood) continue;
    bool barrier = false;
    for (int between = std::min(d, winner) + 1; between < std::max(d, winner); ++between) {
      barrier = barrier || window[between] >= best + kBarrier;
    }
    if (barrier) competitors.push_back(d);
  }
  return competitors;
}

/// Whether the winner fits clearly better than half or more of the disparities whose window the right camera sees.
inline bool isDistinct(const Volume& cost, int u, int v, int winner) {
  const std::vector<int> window = windowCosts(cost, u, v);
  const int best = bestAround(window, winner);
  const int first_u = std::max(u - 3, 0), last_u = std::min(u + 3, cost.size.width_px - 1);
  const auto is_whole = [&](int d) { return seenByRight(cost.size, first_u, d) && seenByRight(cost.size, last_u, d); };
  int worse = 0, others = 0;
  for (int d = 0; d < cost.size.num_disparities; ++d) {
    if (!is_whole(d)) continue;
    ++(window[d] >= best + kClearlyWorse ? worse : others);
  }
  return is_whole(winner) && worse >= others;
}

/// A quotient to the nearest whole number, halves away from zero.
inline int rounded(std::int64_t part, std::int64_t whole) {
  const std::int64_t twice = 2 * std::abs(part) + whole;
  return static_cast<int>((part < 0 ? -1 : 1) * (twice / (2 * whole)));
}

/// Sums over a window.
struct Moments {
  std::int64_t g = 0, e = 0, gg = 0, ge = 0;
};

inline Moments momentsAt(const GreyImage& left, const GreyImage& right, int u, int v, int disparity_px) {
  Moments sum;
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -3; du <= 3; ++du) {
      const int u_left = u + du, u_right = u_left - disparity_px, row = v + dv;
      const int g = greyAt(left, u_left + 1, row) - greyAt(left, u_left - 1, row) + greyAt(right, u_right + 1, row) -
                    greyAt(right, u_right - 1, row);
      const int e = greyAt(right, u_right, row) - greyAt(left, u_left, row);
      sum.g += g;
      sum.e += e;
      sum.gg += g * g;
      sum.ge += g * e;
    }
  }
  return sum;
}

/// Where between whole disparities a match lies [1 / kSubpixels px].
/// @param below, least, above sums at the disparity and one to each side, least the smallest.
inline int subpixelOffset(int below, int least, int above, const Moments& window) {
  if (below == least && above == least) return 0;
  const int p = rounded(kSubpixels * (below - above), 2 * (below + above - 2 * least));
  const std::int64_t num = 4 * (21 * window.ge - window.g * window.e), den = 21 * window.gg - window.g * window.g;
  if (std::abs(num) >= den) return p;
  return rounded(p + rounded(kSubpixels * num + kNoise * p, den + kNoise), 2);
}

/// Average around a pixel of a plane of sub-pixel indices [1 / (kSubpixels kFineSteps) px].
inline int averageAt(const std::vector<std::int16_t>& fixed, int width_px, int height_px, int u, int v) {
  const int middle = fixed[static_cast<std::size_t>(v) * width_px + u];
  int shift = 0, weight = 0;
  for (int dv = -2; dv <= 2; ++dv) {
    for (int du = -2; du <= 2; ++du) {
      if (v + dv < 0 || v + dv >= height_px || u + du < 0 || u + du >= width_px) continue;
      const int difference = fixed[static_cast<std::size_t>(v + dv) * width_px + u + du] - middle;
      const int likeness = std::max(0, kSubpixels - std::abs(difference));
      shift += likeness * difference;
      weight += likeness;
    }
  }
  return kFineSteps * middle + kFineSteps * shift / weight;
}

}  // namespace flight_corridor::oracle
