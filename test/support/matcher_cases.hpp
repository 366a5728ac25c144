#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "flight_corridor/stereo/semi_global_matcher.hpp"
#include "support/matcher_oracle.hpp"

/// Pairs for the matcher's tests, and its outputs compared; without OpenCV, so that they also run where there is none.
namespace flight_corridor::matcher_cases {

enum class Scene { Noise, Surfaces, Stripes, Flat };

/// Rows are longer in memory than in the image.
struct Pair {
  static constexpr int kGap = 5;

  explicit Pair(const MatcherSize& size)
      : width(size.width_px), height(size.height_px), stride(width + kGap), left(memory()), right(memory()) {}

  GreyImage leftView() const { return {left.data(), width, height, stride}; }
  GreyImage rightView() const { return {right.data(), width, height, stride}; }
  std::vector<std::uint8_t> memory() const {
    return std::vector<std::uint8_t>(static_cast<std::size_t>(stride) * height);
  }

  int width, height, stride;
  std::vector<std::uint8_t> left, right;
};

/// Noise of its own in each image; a near box before a slanted wall; stripes upright; or nothing but a little noise.
inline Pair makePair(Scene scene, const MatcherSize& size, unsigned seed) {
  std::mt19937 random(seed);
  const auto grey = [&random](int range) { return static_cast<int>(random() % static_cast<unsigned>(range)); };
  Pair pair(size);
  const int middle_px = size.min_disparity_px + size.num_disparities / 4;
  for (int v = 0; v < pair.height; ++v) {
    for (int u = 0; u < pair.stride; ++u) {
      const std::size_t at = static_cast<std::size_t>(v) * pair.stride + u;
      pair.left[at] = static_cast<std::uint8_t>(scene == Scene::Flat ? 100 + grey(4) : grey(256));
      pair.right[at] = static_cast<std::uint8_t>(scene == Scene::Flat ? 100 + grey(4) : grey(256));
      if (scene == Scene::Stripes) pair.left[at] = pair.right[at] = static_cast<std::uint8_t>(u / 3 % 3 * 60 + grey(3));
    }
    for (int u = 0; scene == Scene::Surfaces && u < pair.width; ++u) {
      const bool box = u > pair.width / 3 && u < pair.width / 2 && v > pair.height / 4;
      const int u_right = u - middle_px - (box ? size.num_disparities / 3 : v / 8);
      if (u_right < 0 || u_right >= pair.width) continue;
      const std::uint8_t* const row = &pair.left[static_cast<std::size_t>(v) * pair.stride];
      pair.right[static_cast<std::size_t>(v) * pair.stride + u_right] =
          static_cast<std::uint8_t>(row[u] / 2 + 20 + grey(3));
    }
  }
  return pair;
}

/// A matcher's outputs; competitors are 0 where there is none.
struct Answers {
  explicit Answers(const MatcherSize& size)
      : pixels(static_cast<std::size_t>(size.width_px) * size.height_px),
        words(storedDisparities(size.num_disparities) / 64),
        best(pixels),
        repeated(pixels),
        competitor_farthest(pixels),
        competitor_nearest(pixels),
        flags(pixels),
        set(pixels * words) {}

  MatchPlanes planes() {
    return {best.data(),  repeated.data(), competitor_farthest.data(), competitor_nearest.data(),
            flags.data(), set.data()};
  }

  std::size_t pixels, words;
  std::vector<float> best, repeated;
  std::vector<std::uint8_t> competitor_farthest, competitor_nearest, flags;
  std::vector<std::uint64_t> set;
};

inline Answers matched(const Pair& pair, const MatcherSize& size, int threads) {
  Answers answers(size);
  BandWorkers workers(threads);
  SemiGlobalMatcher(size, workers).match(pair.leftView(), pair.rightView(), answers.planes());
  return answers;
}

/// @param bands of rows, begun anew.
inline Answers matchedSlowly(const Pair& pair, const MatcherSize& size, int bands) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  const oracle::Volume costs = oracle::costs(pair.leftView(), pair.rightView(), size);
  const oracle::Volume sums = oracle::sums(pair.leftView(), costs, bands);
  Answers answers(size);
  std::vector<std::int16_t> fixed(answers.pixels, kNoSubpixel);
  std::size_t at = 0;
  for (int v = 0; v < size.height_px; ++v) {
    for (int u = 0; u < size.width_px; ++u, ++at) {
      const oracle::Minimum minimum = oracle::minimumAt(sums, u, v);
      const int d = minimum.winner;
      const bool is_match = minimum.flags & kConsistent && oracle::isDistinct(costs, u, v, d);
      const std::vector<int> competitors = is_match ? oracle::competitorsAt(costs, u, v, d) : std::vector<int>();
      const bool repeated = !competitors.empty() && competitors.front() < d;
      answers.flags[at] = static_cast<std::uint8_t>(minimum.flags | (competitors.empty() ? 0 : kCompetitor) |
                                                    (repeated ? kRepeated : 0) | (is_match ? kDistinct : 0));
      answers.competitor_farthest[at] = static_cast<std::uint8_t>(competitors.empty() ? 0 : competitors.front());
      answers.competitor_nearest[at] = static_cast<std::uint8_t>(competitors.empty() ? 0 : competitors.back());
      for (std::size_t i = 0; i < minimum.set.size(); ++i) {
        if (minimum.set[i]) answers.set[at * answers.words + i / 64] |= std::uint64_t{1} << i % 64;
      }
      if (!is_match) continue;
      const bool inside = 0 < d && d + 1 < size.num_disparities;
      const oracle::Moments moments =
          oracle::momentsAt(pair.leftView(), pair.rightView(), u, v, d + size.min_disparity_px);
      const int offset =
          inside ? oracle::subpixelOffset(sums.at(u, v, d - 1), sums.at(u, v, d), sums.at(u, v, d + 1), moments) : 0;
      fixed[at] = static_cast<std::int16_t>(d * kSubpixels + offset);
    }
  }
  at = 0;
  for (int v = 0; v < size.height_px; ++v) {
    for (int u = 0; u < size.width_px; ++u, ++at) {
      answers.best[at] = answers.repeated[at] = kNone;
      if (fixed[at] == kNoSubpixel) continue;
      const int fine = oracle::averageAt(fixed, size.width_px, size.height_px, u, v);
      const float best_px = static_cast<float>(fine) / static_cast<float>(kSubpixels * kFineSteps) +
                            (static_cast<float>(size.min_disparity_px) - size.offset_px);
      if (best_px < -kLargestOffset_px) continue;
      (answers.flags[at] & kRepeated ? answers.repeated : answers.best)[at] = std::max(best_px, kSmallestDisparity_px);
    }
  }
  return answers;
}

inline Answers matchedSlowly(const Pair& pair, const MatcherSize& size) {
  return matchedSlowly(pair, size, oracle::bandsOf(size.height_px));
}

/// "" where two are equal, bit by bit; otherwise what differs first, and where.
inline std::string firstDifference(const Answers& one, const Answers& other) {
  for (std::size_t i = 0; i < one.pixels; ++i) {
    const std::string place = " differs at pixel " + std::to_string(i);
    if (one.flags[i] != other.flags[i]) return "flags" + place;
    if (std::memcmp(&one.set[i * one.words], &other.set[i * one.words], one.words * sizeof(std::uint64_t)) != 0) {
      return "set" + place;
    }
    if (one.competitor_farthest[i] != other.competitor_farthest[i]) return "farthest competitor" + place;
    if (one.competitor_nearest[i] != other.competitor_nearest[i]) return "nearest competitor" + place;
    for (const auto plane : {&Answers::best, &Answers::repeated}) {
      const float a = (one.*plane)[i], b = (other.*plane)[i];
      if (a == b || (std::isnan(a) && std::isnan(b))) continue;
      return (plane == &Answers::best ? "best" : "repeated") + place + ": " + std::to_string(a) + ", " +
             std::to_string(b);
    }
  }
  return "";
}

inline std::vector<MatcherSize> sizes() {
  return {{2, 2, 0, 32},     {3, 5, -2, 32},           {31, 7, 0, 64},     {65, 33, -7, 96},
          {97, 9, 3, 128},   {130, 6, 40, 160, 41.7f}, {75, 11, -90, 128}, {301, 4, -2, 256, -0.4f},
          {50, 190, -2, 32}, {33, 305, 1, 64}};
}

constexpr Scene kScenes[] = {Scene::Noise, Scene::Surfaces, Scene::Stripes, Scene::Flat};

inline std::string describe(Scene scene, const MatcherSize& size) {
  return "scene " + std::to_string(static_cast<int>(scene)) + ", " + std::to_string(size.width_px) + " x " +
         std::to_string(size.height_px) + ", disparities from " + std::to_string(size.min_disparity_px) + ", " +
         std::to_string(size.num_disparities) + ": ";
}

}  // namespace flight_corridor::matcher_cases
