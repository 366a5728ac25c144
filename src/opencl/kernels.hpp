#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "flight_corridor/stereo/matching_rules.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"

namespace flight_corridor::opencl {

// Work-groups of semi_global_matcher.cl.
constexpr int kLanes = 32;  ///< Of aggregate, along disparity.
constexpr int kGroup = 64;  ///< Work-items of findMinima and judge.
constexpr int kTile_px = 32;

/// Memory of the device.
enum Buffer : std::uint8_t {
  kLeft,
  kRight,
  kLeftCodes,
  kRightCodes,
  kFromLeft,
  kFromRight,
  kFromAbove,
  kFromAboveLeft,
  kFromAboveRight,
  kWinners,
  kRisesBelow,
  kRisesAbove,
  kFlags,
  kSet,
  kFarthest,
  kNearest,
  kFixed,
  kBest,
  kRepeatedBest,
  kPairNumber,  ///< Of the pair that is uploaded; a word.
  kDone,        ///< Of the last pair that was matched: what was downloaded is its evidence.
  kBuffers
};

/// Its rows and bytes a row.
inline std::pair<int, int> extentOf(Buffer buffer, const MatcherSize& size) {
  const auto of_pixels = [&](int bytes) { return std::pair(size.height_px, size.width_px * bytes); };
  switch (buffer) {
    case kPairNumber:
    case kDone:
      return {1, sizeof(std::uint32_t)};
    case kFromLeft:
    case kFromRight:
    case kFromAbove:
    case kFromAboveLeft:
    case kFromAboveRight:
      return of_pixels(size.num_disparities);
    case kSet:
      return of_pixels(storedDisparities(size.num_disparities) / 8);
    case kBest:
    case kRepeatedBest:
      return of_pixels(sizeof(float));
    case kLeftCodes:
    case kRightCodes:
    case kFixed:
      return of_pixels(sizeof(std::uint16_t));
    default:
      return of_pixels(1);
  }
}

/// Bytes of a work-group's local memory, at most.
inline std::size_t localMemory(const MatcherSize& size) {
  const std::size_t width = size.width_px, stride = size.num_disparities + 4;
  const std::size_t find_minima = width * (sizeof(std::uint32_t) + 1) + kTile_px * stride;
  return std::max(find_minima, (2 * kTile_px + 2 * kWindowReach_px) * stride);  // of judge
}

/// A kernel to run: its arguments, and its work-items in groups.
struct Step {
  const char* kernel;
  std::vector<Buffer> arguments;
  std::array<std::size_t, 3> work_items, group;
};

/// All that matches a pair, in this order, from kLeft and kRight.
inline std::vector<Step> stepsFor(const MatcherSize& size) {
  const auto rounded_up = [](int count, int step) {
    return static_cast<std::size_t>((count + step - 1) / step * step);
  };
  const std::size_t width = size.width_px, height = size.height_px, bands = bandsOf(size.height_px), group = kGroup;
  const std::size_t lines = width + (height + bands - 1) / bands + SemiGlobalMatcher::kRunUp_px;  // of an oblique path
  const std::array<std::size_t, 3> tile{16, 4, 1},
      pixels{rounded_up(size.width_px, 16), rounded_up(size.height_px, 4), 1};
  return {{"census", {kLeft, kLeftCodes}, pixels, tile},
          {"census", {kRight, kRightCodes}, pixels, tile},
          {"aggregate",
           {kLeft, kLeftCodes, kRightCodes, kFromLeft, kFromRight, kFromAbove, kFromAboveLeft, kFromAboveRight},
           {lines * kLanes, bands, 5},
           {kLanes, 1, 1}},
          {"findMinima",
           {kFromLeft, kFromRight, kFromAbove, kFromAboveLeft, kFromAboveRight, kWinners, kRisesBelow, kRisesAbove,
            kFlags, kSet},
           {height * group, 1, 1},
           {group, 1, 1}},
          {"judge",
           {kLeftCodes, kRightCodes, kWinners, kFlags, kFarthest, kNearest},
           {(width + kTile_px - 1) / kTile_px * group, height, 1},
           {group, 1, 1}},
          {"fit", {kLeft, kRight, kWinners, kRisesBelow, kRisesAbove, kFlags, kFixed}, pixels, tile},
          {"average", {kFixed, kFlags, kBest, kRepeatedBest, kPairNumber, kDone}, pixels, tile}};
}

/// What a pair leaves on the device, and where it goes.  @param done the number of the pair that it is of.
inline std::vector<std::pair<Buffer, void*>> resultsTo(const MatchPlanes& out, std::uint32_t& done) {
  return {{kSet, out.set},
          {kFlags, out.flags},
          {kFarthest, out.competitor_farthest},
          {kNearest, out.competitor_nearest},
          {kBest, out.best},
          {kRepeatedBest, out.repeated},
          {kDone, &done}};
}

/// Options of the OpenCL compiler: the images' size, the search range, and the rules' numbers.
inline std::string kernelOptions(const MatcherSize& size) {
  std::string options;
  const auto define = [&options](const char* name, long value) {
    options += std::string("-D ") + name + "=(" + std::to_string(value) + ") ";
  };
  const auto define_float = [&](const char* name, float value) {  // every bit of it, whatever the locale
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    options += std::string("-D ") + name + "=as_float(" + std::to_string(bits) + "u) ";
  };
  define("WIDTH", size.width_px);
  define("HEIGHT", size.height_px);
  define("MIN_DISPARITY", size.min_disparity_px);
  define("DISPARITIES", size.num_disparities);
  define_float("OFFSET_PX", size.offset_px);
  define("BANDS", bandsOf(size.height_px));
  define("RUN_UP", SemiGlobalMatcher::kRunUp_px);
  define("LANES", kLanes);
  define("GROUP", kGroup);
  define("TILE", kTile_px);
#define FLIGHT_CORRIDOR_DEFINE(name) define(#name, name)
  FLIGHT_CORRIDOR_DEFINE(kCensusReach_px);
  FLIGHT_CORRIDOR_DEFINE(kBrighter_grey);
  FLIGHT_CORRIDOR_DEFINE(kUnseenCost);
  FLIGHT_CORRIDOR_DEFINE(kSmallStepPenalty);
  FLIGHT_CORRIDOR_DEFINE(kLargeStepPenalty);
  FLIGHT_CORRIDOR_DEFINE(kEdgeStepPenalty);
  FLIGHT_CORRIDOR_DEFINE(kEdge_grey);
  FLIGHT_CORRIDOR_DEFINE(kContradiction);
  FLIGHT_CORRIDOR_DEFINE(kConsistent_px);
  FLIGHT_CORRIDOR_DEFINE(kWindowReach_px);
  FLIGHT_CORRIDOR_DEFINE(kAsGood);
  FLIGHT_CORRIDOR_DEFINE(kBarrier);
  FLIGHT_CORRIDOR_DEFINE(kClearlyWorse);
  FLIGHT_CORRIDOR_DEFINE(kSubpixels);
  FLIGHT_CORRIDOR_DEFINE(kNoise);
  FLIGHT_CORRIDOR_DEFINE(kNoSubpixel);
  FLIGHT_CORRIDOR_DEFINE(kAverageReach_px);
  FLIGHT_CORRIDOR_DEFINE(kFineSteps);
  FLIGHT_CORRIDOR_DEFINE(kConsistent);
  FLIGHT_CORRIDOR_DEFINE(kCompetitor);
  FLIGHT_CORRIDOR_DEFINE(kDistinct);
  FLIGHT_CORRIDOR_DEFINE(kRepeated);
#undef FLIGHT_CORRIDOR_DEFINE
  define_float("kLargestOffset_px", kLargestOffset_px);
  define_float("kSmallestDisparity_px", kSmallestDisparity_px);
  return options;
}

}  // namespace flight_corridor::opencl
