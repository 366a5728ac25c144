#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "flight_corridor/corridor/verdict.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// What is remembered of stereo pairs: whether their images can be two cameras' at that moment.
class ImageWatch {
 public:
  /// @return reasons: kBadImage where left and right are one image, kFrozenImage where an image equals that of a pair
  /// before under another stamp; both bit-identical, which a camera's noise does not allow.
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
