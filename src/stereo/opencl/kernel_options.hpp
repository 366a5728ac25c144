#pragma once

#include <cstdio>
#include <string>

#include "flight_corridor/stereo/matching_rules.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"

namespace flight_corridor::opencl {

// Work-groups of semi_global_matcher.cl.
constexpr int kLanes = 32;  ///< Of aggregate, along disparity.
constexpr int kGroup = 64;  ///< Work-items of findMinima and judge.
constexpr int kTile_px = 32;

/// Options of the OpenCL compiler: the images' size, the search range, and the rules' numbers.
inline std::string kernelOptions(const MatcherSize& size) {
  std::string options;
  const auto define = [&options](const char* name, long value) {
    options += std::string("-D ") + name + "=" + std::to_string(value) + " ";
  };
  const auto define_float = [&options](const char* name, double value) {
    char text[64];
    std::snprintf(text, sizeof text, "-D %s=%af ", name, value);  // every bit of it
    options += text;
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
  FLIGHT_CORRIDOR_DEFINE(kAverageReach_px);
  FLIGHT_CORRIDOR_DEFINE(kFineSteps);
  FLIGHT_CORRIDOR_DEFINE(kConsistent);
  FLIGHT_CORRIDOR_DEFINE(kCompetitor);
  FLIGHT_CORRIDOR_DEFINE(kDistinct);
  FLIGHT_CORRIDOR_DEFINE(kRepeated);
#undef FLIGHT_CORRIDOR_DEFINE
  options += "-D kNoSubpixel=(" + std::to_string(kNoSubpixel) + ") ";
  define_float("kLargestOffset_px", kLargestOffset_px);
  define_float("kSmallestDisparity_px", kSmallestDisparity_px);
  return options;
}

}  // namespace flight_corridor::opencl
