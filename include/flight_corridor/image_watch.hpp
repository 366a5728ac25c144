#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "flight_corridor/corridor/verdict.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Checks by memory of earlier pairs whether the images can be two cameras' at that moment.
class ImageWatch {
 public:
  /// @return reasons: kBadImage if left and right are bit-identical, kFrozenImage if an image is bit-identical to that
  /// of an earlier pair with another stamp: a camera's noise does not allow either.
  std::uint32_t faults(const StereoFrame& frame);

 private:
  struct Seen {  // fingerprints of a pair's images
    double stamp_s = kNaN;
    std::size_t left = 0, right = 0;
  };

  std::array<Seen, 8> seen_;  // the last pairs; drivers that hang repeat one buffer or a few
  std::size_t oldest_ = 0;
};

}  // namespace flight_corridor
