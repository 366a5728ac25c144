#pragma once

#include <string>
#include <vector>

#include "tools/stereo_cameras.hpp"

namespace flight_corridor::tools {

/// A camera of a calibration that may hold many.
struct NamedCamera {
  std::string name, topic;  ///< topic: of the images that it was calibrated with; empty: not known.
};

/// The two that a pair of image topics is of: those that are named; else those of the same topics, whatever their
/// compression, or of topics in the same folders (/stereo/left/image_raw, /stereo/left/image_rect). Of two cameras the
/// other is the other, and the first is left where nothing is known.
/// @param named cameras, topics what may be known of each; empty: nothing.
/// @throws std::runtime_error naming the cameras and the options that choose, where this does not decide.
PairNames choosePair(const std::vector<NamedCamera>& cameras, const PairNames& named, const PairNames& topics);

}  // namespace flight_corridor::tools
